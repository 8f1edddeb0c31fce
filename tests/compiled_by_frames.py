"""Write how many kernels there are and which of them frames compile anew: python -m tests.compiled_by_frames"""

import gc
import sys
from dataclasses import replace
from math import radians

from numba.core.dispatcher import Dispatcher

from cliffscan.common.contract.camera import FloorPlane, Region
from cliffscan.common.contract.depth_codec import LEVELS, RAW
from cliffscan.common.contract.messages import DepthImage
from cliffscan.common.runtime.config import PROFILES
from cliffscan.compile import compile_perception
from cliffscan.services.perception.perceive import Settings, perceive
from tests import scenes


def frames():
    """Frames of several mounts, as they come from the network."""
    for pitch, roll in (0.0, 0.0), (20.0, 2.0), (10.0, 80.0):  # of the last one rows are columns
        camera = scenes.camera(floor=FloorPlane.from_mount(0.3, radians(pitch), radians(roll)))
        for seen in (None, Region(2, 2, 60, 44)):
            part = replace(camera, seen=seen)
            depth = scenes.depth(part, holes=[scenes.HOLE], boxes=[(1.0, 0.7, 0.0, 1.2, 0.9, 0.3)])
            for encoding in (RAW, LEVELS):
                yield DepthImage.decode(DepthImage.pack(0, 0, "camera", depth, part, encoding).encode())


def main():
    """Compile, perceive, and compare."""
    compile_perception()
    kernels = [each for each in gc.get_objects() if isinstance(each, Dispatcher) and each.signatures]
    before = [len(kernel.signatures) for kernel in kernels]
    for frame in frames():
        for profile in PROFILES:
            perceive(frame, Settings.of_profile(profile))
    more = (len(kernel.signatures) > count for kernel, count in zip(kernels, before, strict=True))
    compiled = [kernel.py_func.__qualname__ for kernel, again in zip(kernels, more, strict=True) if again]
    sys.stdout.write(" ".join([str(len(kernels)), *compiled]))


if __name__ == "__main__":
    main()
