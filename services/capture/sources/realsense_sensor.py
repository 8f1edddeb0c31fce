"""What Intel's RealSense cameras measure, live and in a recording."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from cliffscan.common.contract.limits import FARTHEST_REACH, MOST_NOISE

DISPARITY_NOISE = 0.1  # [px] standard deviation of a D400's disparity indoors, its steps of 1/32 px included
WIDEST_DISPARITY = 126  # [px] in which a D400 looks for a match, so what is nearer returns nothing
TRUSTED = 0.2  # [m] standard deviation of a depth up to which it is trusted
LARGEST = np.iinfo(np.uint16).max  # [mm]


class Sensor(NamedTuple):
    """range: [m] along the optical axis; noise: [1/m] of the inverse depth, steps included; baseline: [m]."""

    range: tuple[float, float]
    noise: float
    baseline: float


ONE_EYE = Sensor((0.25, 9.0), 2.0e-3, 0.0)  # an L515, which measures the time of flight


def sensor_of(focal: float, baseline: float) -> Sensor:
    """By the focal length [px] and the baseline [m], which is 0 of a camera with one eye."""
    return stereo(focal, baseline) if baseline else ONE_EYE


def stereo(focal: float, baseline: float) -> Sensor:
    """What a stereo camera measures, by its focal length [px] and baseline [m]: depth is focal·baseline/disparity."""
    noise = min(DISPARITY_NOISE / (focal * baseline), MOST_NOISE)
    far = min(math.sqrt(TRUSTED / noise), FARTHEST_REACH)
    return Sensor((focal * baseline / WIDEST_DISPARITY, far), noise, baseline)


def millimetres(pixels: NDArray[np.uint16], unit: float) -> NDArray[np.uint16]:
    """A copy of the depths in `unit` [m], as depths [mm]; 0 = no return, and so what millimetres cannot express."""
    if math.isclose(unit, 1e-3, rel_tol=1e-5):
        return pixels.copy()
    depth = np.rint(pixels * (1000.0 * unit))
    return np.where(depth <= LARGEST, depth, 0).astype(np.uint16)
