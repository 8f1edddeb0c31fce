"""A time of flight camera's view of a depth image (Kinect v2, Azure Kinect): noise nearly constant in depth, no steps.

Its light comes from beside the lens, so it casts no shadow. Wasenmüller and Stricker 2016, Tölgyessy et al. 2021.
"""

from dataclasses import dataclass

import numpy as np

from cliffscan.simulator.kinect import NORMAL, Image, Millimetres, SensorModel, draw_tickets


@dataclass(frozen=True, kw_only=True)
class TimeOfFlightModel(SensorModel):
    """noise: [m] standard deviation of the depth; growth: by how much of it that grows with each metre."""

    noise: float
    growth: float = 0.1
    baseline: float = 0.0

    def millimetres(self, inverse: Image, reach: tuple[float, float], rng: np.random.Generator) -> Millimetres:
        """See SensorModel."""
        near, far = reach
        depth = np.reciprocal(inverse, out=np.zeros_like(inverse), where=inverse > 0.0)
        deviation = np.float32(self.noise) * (1.0 + np.float32(self.growth) * (depth - 1.0))
        measured = depth + deviation * NORMAL[draw_tickets(depth.shape, rng)]
        seen = (inverse > 0.0) & (measured >= near) & (measured <= far)
        return np.where(seen, np.rint(1000.0 * measured), 0.0).astype(np.uint16)
