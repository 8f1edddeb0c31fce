"""The methods by name, each a function of what a depth image tells of the floor."""

from __future__ import annotations

from collections.abc import Callable, Iterable

from cliffscan.common.contract.beam_fields import Beams
from cliffscan.common.contract.evidence import Evidence
from cliffscan.common.contract.messages import DepthImage
from cliffscan.common.perception.combine import beams_with, within
from cliffscan.common.perception.point_heights import Points
from cliffscan.common.perception.scans import points
from cliffscan.services.negative.config import Method, NegativeConfig
from cliffscan.services.negative.farthest_point import farthest_point
from cliffscan.services.negative.near_edge import near_edge
from cliffscan.services.negative.virtual_floor import virtual_floor


def _farthest_point(seen: Points, config: NegativeConfig) -> Beams:
    return beams_with(farthest_point(seen, config.grid(), config.floor_band), Evidence.FARTHEST_FLOOR)


def _virtual_floor(seen: Points, config: NegativeConfig) -> Beams:
    return beams_with(virtual_floor(seen, config.grid(), config.floor_band), Evidence.DROP)


def _near_edge(seen: Points, config: NegativeConfig) -> Beams:
    criteria = config.criteria(seen.view.camera)
    return near_edge(seen, config.grid(), criteria, config.floor_lost, config.baseline)


RUN: dict[Method, Callable[[Points, NegativeConfig], Beams]] = {
    "farthest_point": _farthest_point,
    "virtual_floor": _virtual_floor,
    "near_edge": _near_edge,
}


def beams_by_method(image: DepthImage, config: NegativeConfig, methods: Iterable[Method]) -> dict[Method, Beams]:
    """What each of these methods finds in `image`."""
    seen = points(image, config, lower_than=config.floor_band)
    reach = config.reach(image.camera)
    return {method: within(RUN[method](seen, config), reach) for method in methods}
