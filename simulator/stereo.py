"""A stereo camera's view of a depth image (RealSense D4xx): it matches windows, so errs alike in all of a window.

A pixel's disparity is that of its window: edges are smeared over it, and the noise of neighbours is correlated. The
noise is constant in disparity, 0.08 to 0.12 px, so in inverse depth.
"""

from dataclasses import dataclass

import numpy as np
from numba import njit

from cliffscan.simulator.kinect import NORMAL, Image, Millimetres, SensorModel, quantise


@dataclass(frozen=True, kw_only=True)
class StereoModel(SensorModel):
    """noise: [1/m] standard deviation of the inverse depth; step: [1/m] of it, 1/32 px; window: its half width [px]."""

    noise: float
    step: float
    window: int = 4

    def millimetres(self, inverse: Image, reach: tuple[float, float], rng: np.random.Generator) -> Millimetres:
        """See SensorModel."""
        matched = window_means(inverse, self.window)
        errors = window_means(rng.standard_normal(inverse.shape, dtype=np.float32), self.window)
        matched += np.float32(self.noise) * (2 * self.window + 1) * errors  # a mean of n² errs by 1/n of one
        matched[inverse == 0.0] = 0.0
        reported = np.empty(inverse.shape, dtype=np.uint16)
        quantise(matched, np.zeros(inverse.shape, dtype=np.uint16), NORMAL, 0.0, self.step, *reach, reported)
        return reported


def window_means(values: Image, window: int) -> Image:
    """The mean of what is not 0 in the window of 2 window + 1 px around each pixel, (rows, cols); 0 where all is."""
    there = (values != 0.0).astype(np.float32)
    total, count = (window_sums(window_sums(each, window).T, window).T for each in (values, there))
    return np.divide(total, count, out=np.zeros_like(values), where=count > 0.0)


@njit(cache=True)
def window_sums(values: Image, window: int) -> Image:
    """The sums over 2 window + 1 values along each row, fewer at its ends."""
    rows, cols = values.shape
    sums = np.empty((rows, cols), dtype=np.float32)
    cumulated = np.empty(cols + 1, dtype=np.float64)
    cumulated[0] = 0.0
    for v in range(rows):
        for u in range(cols):
            cumulated[u + 1] = cumulated[u] + values[v, u]
        for u in range(cols):
            sums[v, u] = cumulated[min(u + window + 1, cols)] - cumulated[max(u - window, 0)]
    return sums
