"""The beams of a scan: their azimuths, and the one that sees a given azimuth."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from common.geometry import Floats


class Grid(NamedTuple):
    """Evenly spaced beams from angle_min to angle_max [rad], counter-clockwise, so from right to left."""

    beams: int
    angle_min: float
    angle_max: float

    @property
    def increment(self) -> float:
        """Angle [rad] between two beams."""
        return (self.angle_max - self.angle_min) / (self.beams - 1)

    def angles(self) -> Floats:
        """Azimuth [rad] of each beam: (beams,)."""
        return self.angle_min + self.increment * np.arange(self.beams, dtype=np.float64)

    def edges(self) -> Floats:
        """Azimuths [rad] that bound the beams, half an increment to either side of each: (beams + 1,)."""
        return self.angle_min + self.increment * (np.arange(self.beams + 1, dtype=np.float64) - 0.5)

    def beam_of(self, azimuth: Floats) -> NDArray[np.int64]:
        """Number of the beam nearest to each azimuth [rad]; beyond the grid it is negative or too large. Eq. (2)."""
        return np.floor((azimuth - self.angle_min) / self.increment + 0.5).astype(np.int64)
