"""A stereo camera's view of a depth image (RealSense D4xx): it matches windows, so errs alike in all of a window.

A pixel's disparity is that of its window: edges are smeared over it, and the noise of neighbours is correlated. The
noise is constant in disparity, 0.08 to 0.12 px, so in inverse depth.
"""

from dataclasses import dataclass

import numpy as np
from numba import njit

from cliffscan.simulator.kinect import NORMAL, Image, Millimetres, SensorModel, draw_tickets, quantise


@dataclass(frozen=True, kw_only=True)
class StereoModel(SensorModel):
    """noise: [1/m] standard deviation of the inverse depth; step: [1/m] of it, 1/32 px; window: its half width [px]."""

    noise: float
    step: float
    window: int = 4

    def millimetres(self, inverse: Image, reach: tuple[float, float], rng: np.random.Generator) -> Millimetres:
        """See SensorModel."""
        matched = window_means(inverse, self.window)
        errors = window_means(NORMAL[draw_tickets(inverse.shape, rng)], self.window)
        matched += np.float32(self.noise) * (2 * self.window + 1) * errors  # a mean of n² errs by 1/n of one
        matched[inverse == 0.0] = 0.0
        reported = np.empty(inverse.shape, dtype=np.uint16)
        quantise(matched, np.zeros(inverse.shape, dtype=np.uint16), NORMAL, 0.0, self.step, *reach, reported)
        return reported


@njit(cache=True)
def window_means(values: Image, window: int) -> Image:
    """The mean of what is not 0 in the window of 2 window + 1 px around each pixel, (rows, cols); 0 where all is."""
    rows, cols = values.shape
    means = np.zeros((rows, cols), dtype=np.float32)
    sums, counts = np.zeros(cols), np.zeros(cols)  # of the window's rows, by column
    for v in range(-window, rows):
        if v + window < rows:
            for u in range(cols):
                sums[u] += values[v + window, u]
                counts[u] += values[v + window, u] != 0.0
        if v - window > 0:
            for u in range(cols):
                sums[u] -= values[v - window - 1, u]
                counts[u] -= values[v - window - 1, u] != 0.0
        if v >= 0:
            total, count = sums[:window].sum(), counts[:window].sum()
            for u in range(cols):
                total += sums[u + window] if u + window < cols else 0.0
                count += counts[u + window] if u + window < cols else 0.0
                means[v, u] = total / count if count > 0.5 else 0.0
                total -= sums[u - window] if u >= window else 0.0
                count -= counts[u - window] if u >= window else 0.0
    return means
