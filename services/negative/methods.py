"""The methods by name, each a function of what a depth image tells of the floor."""

from __future__ import annotations

from collections.abc import Callable

from common.combine import Beams
from common.evidence import Evidence
from common.messages import DepthImage
from common.points import Points
from common.scans import points
from services.negative.config import Method, NegativeConfig
from services.negative.farthest_point import farthest_point
from services.negative.virtual_floor import virtual_floor

RUN: dict[Method, Callable[[Points, float, float], Beams]] = {
    "farthest_point": lambda seen, band, _height: Beams.of(farthest_point(*seen, band), Evidence.FARTHEST_FLOOR),
    "virtual_floor": lambda seen, band, height: Beams.of(virtual_floor(*seen, band, height), Evidence.DROP),
}


def beams_by_method(image: DepthImage, config: NegativeConfig) -> dict[Method, Beams]:
    """What each configured method finds in `image`."""
    seen = points(image, config)
    reach = config.reach(image.camera)
    return {
        method: RUN[method](seen, config.floor_band, image.camera.floor.d).within(reach) for method in config.methods
    }
