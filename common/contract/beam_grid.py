"""The beams of a scan: their azimuths, and the one that sees a given azimuth."""

from typing import NamedTuple, Self

import numpy as np
from numpy.typing import NDArray

from cliffscan.common.contract.camera import Floats


class Grid(NamedTuple):
    """Evenly spaced beams from angle_min on, counter-clockwise, so from right to left."""

    beams: int
    angle_min: float  # [rad]
    increment: float  # [rad]

    @classmethod
    def between(cls, beams: int, angle_min: float, angle_max: float) -> Self:
        """The grid whose first and last beam have these azimuths [rad]; at least two beams."""
        return cls(beams, angle_min, (angle_max - angle_min) / (beams - 1))

    @property
    def angle_max(self) -> float:
        """Azimuth [rad] of the last beam."""
        return self.angle_min + (self.beams - 1) * self.increment

    def matches(self, other: Self) -> bool:
        """Whether both have the same beams, but for what rounding does to their angles."""
        slack = 0.01 * self.increment
        ends = (self.angle_min - other.angle_min, self.angle_max - other.angle_max)
        return self.beams == other.beams and all(abs(end) <= slack for end in ends)

    def angles(self) -> Floats:
        """Azimuth [rad] of each beam: (beams,)."""
        return self.angle_min + self.increment * np.arange(self.beams, dtype=np.float64)

    def edges(self) -> Floats:
        """Azimuths [rad] that bound the beams, half an increment to either side of each: (beams + 1,)."""
        return self.angle_min + self.increment * (np.arange(self.beams + 1, dtype=np.float64) - 0.5)

    def beam_of(self, azimuth: Floats) -> NDArray[np.int64]:
        """Number of the beam nearest to each azimuth [rad]; beyond the grid it is negative or too large. Eq. (2)."""
        return np.floor((azimuth - self.angle_min) / self.increment + 0.5).astype(np.int64)
