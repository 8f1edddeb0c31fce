"""The methods of negative by name, as each registers itself in its own file below services/negative/methods."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple, TypeVar

from cliffscan.common.contract.beam_fields import Beams
from cliffscan.common.perception.floor_points import FloorPoints
from cliffscan.common.perception.scans import ImageScanConfig

C = TypeVar("C", bound=ImageScanConfig)


class Method(NamedTuple):
    """A method: what finds beams in an image's points, and the settings that it reads."""

    find: Callable[[FloorPoints, Any], Beams]
    settings: type[ImageScanConfig]


METHODS: dict[str, Method] = {}


def negative_method(
    name: str, settings: type[C]
) -> Callable[[Callable[[FloorPoints, C], Beams]], Callable[[FloorPoints, C], Beams]]:
    """Register a function as the method `name`, which scan/negative/<name> and negative.methods are called after.

    settings: ImageScanConfig, or a class of that with further settings, which become negative's.
    """

    def register(find: Callable[[FloorPoints, C], Beams]) -> Callable[[FloorPoints, C], Beams]:
        METHODS[name] = Method(find, settings)
        return find

    return register
