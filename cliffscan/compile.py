"""Compile the kernels of perception before a service needs them: python -m cliffscan.compile

numba keeps them for a processor of this kind. On another kind a service compiles them when it starts, as it does
without this.
"""

from cliffscan.common.contract.depth_codec import compile_loops
from cliffscan.common.perception.scans import WARMUP_IMAGE
from cliffscan.common.runtime.config import PROFILES
from cliffscan.services.perception.perceive import Settings, perceive


def compile_perception() -> None:
    """Compile what negative, positive and perception run, whatever their profile, or load it where it is kept."""
    compile_loops()
    for profile in PROFILES:
        perceive(WARMUP_IMAGE, Settings.of_profile(profile))


if __name__ == "__main__":
    compile_perception()
