"""What the methods of negative report on a frame, each alone and combined as the paper and the defaults do."""

from collections.abc import Callable, Mapping, Sequence

from benchmarks.accuracy.frames import Frame
from cliffscan.common.contract.beam_fields import Beams
from cliffscan.common.contract.depth_codec import RAW
from cliffscan.common.contract.messages import DepthImage
from cliffscan.common.perception.combine import combine
from cliffscan.services.negative.config import NegativeConfig
from cliffscan.services.negative.methods import METHODS
from cliffscan.services.negative.scans import negative_scans

PAPER: tuple[str, ...] = ("farthest_point", "virtual_floor")
BEST = "near_edge"  # the scan whose worst cases are drawn
CONFIG = NegativeConfig(methods=tuple(METHODS))
ANGLES = CONFIG.grid().angles()  # [rad]

Others = Mapping[str, Callable[[Frame], Beams]]  # scans of other programs, by name: what they report at ANGLES


def known_scans() -> dict[str, tuple[str, ...]]:
    """The scans that are scored, by name, and the methods that each combines."""
    scans: dict[str, tuple[str, ...]] = {method: (method,) for method in METHODS}
    scans["paper"] = PAPER
    default = NegativeConfig().methods
    if set(default) not in (set(methods) for methods in scans.values()):
        scans["default"] = default
    return scans


def beams_of(frame: Frame, names: Sequence[str]) -> dict[str, Beams]:
    """What each scan tells."""
    scans = {name: known_scans()[name] for name in names}
    used = tuple(method for method in METHODS if any(method in methods for methods in scans.values()))
    image = DepthImage.pack(0, 0, "", frame.depth, frame.camera, RAW)
    found = negative_scans(image, CONFIG, used).by_method
    return {name: combine([found[method] for method in methods]) for name, methods in scans.items()}


def all_beams(frame: Frame, names: Sequence[str], others: Others) -> dict[str, Beams]:
    """What our scans of these names tell, and then others'."""
    return {**beams_of(frame, names), **{name: ask(frame) for name, ask in others.items()}}
