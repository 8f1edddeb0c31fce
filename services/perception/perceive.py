"""From a depth image to all of its scans, as negative, positive and fuse make them."""

from collections.abc import Collection
from typing import NamedTuple, Self

from cliffscan.common.contract.messages import DepthImage, LaserScan
from cliffscan.common.runtime.config import PROFILES
from cliffscan.services.fuse.fusion import fuse
from cliffscan.services.fuse.pairing import Pair
from cliffscan.services.negative.config import NegativeConfig
from cliffscan.services.negative.scans import NegativeScans, negative_scans
from cliffscan.services.positive.config import PositiveConfig
from cliffscan.services.positive.scan import positive_scan


class Settings(NamedTuple):
    """How the three services are configured, and the methods that are wanted beside those that are combined."""

    negative: NegativeConfig = NegativeConfig()
    positive: PositiveConfig = PositiveConfig()
    methods: Collection[str] = ()

    @classmethod
    def of_profile(cls, profile: str) -> Self:
        """The settings of one of PROFILES."""
        if profile not in PROFILES:
            raise ValueError(f"profile {profile!r} is none of {', '.join(PROFILES)}")
        negative, positive = (kind.PROFILES.get(profile, {}) for kind in (NegativeConfig, PositiveConfig))
        return cls(NegativeConfig.model_validate(negative), PositiveConfig.model_validate(positive))


class Scans(NamedTuple):
    """The scans of one depth image."""

    positive: LaserScan
    by_method: dict[str, LaserScan]
    negative: LaserScan
    fused: LaserScan


class Unfused(NamedTuple):
    """The scans of one depth image that fuse takes, and those of negative's methods."""

    positive: LaserScan
    negative: NegativeScans


def sense(image: DepthImage, settings: Settings) -> Unfused:
    """The scans that negative and positive make of `image`."""
    return Unfused(positive_scan(image, settings.positive), negative_scans(image, settings.negative, settings.methods))


def perceive(image: DepthImage, settings: Settings) -> Scans:
    """All scans of `image`. Raises GridMismatch where positive and negative are configured with different beams."""
    positive, (by_method, negative) = sense(image, settings)
    return Scans(positive, by_method, negative, fuse(Pair(positive, negative), {}))
