"""The depth sensors that can be simulated: what is known of each without its model, so without a compiler."""

import math
from typing import NamedTuple

from cliffscan.common.contract.camera import KINECT_BASELINE, KINECT_NOISE, Camera, FloorPlane, Intrinsics


class Sensor(NamedTuple):
    """A sensor's image, its range, and the noise and baseline that its camera carries.

    size: width and height [px]; field_of_view: [deg] across and upright; range: [m]; noise: [1/m] standard deviation of
    the inverse depth, steps included; baseline: [m].
    """

    size: tuple[int, int]
    field_of_view: tuple[float, float]
    range: tuple[float, float]
    noise: float
    baseline: float


# The noise of a time of flight camera is nearly constant in depth. The one that is given here is right at 1 m; nearer,
# what it says of a floor's height is less than a millimetre off, and farther it is larger than what is so.
SENSORS = {
    "kinect": Sensor((640, 480), (58.0, 45.0), (0.5, 4.5), KINECT_NOISE, KINECT_BASELINE),
    "kinect_v2": Sensor((512, 424), (70.6, 60.0), (0.5, 4.5), 2.0e-3, 0.0),
    "azure_kinect": Sensor((640, 576), (75.0, 65.0), (0.5, 3.86), 1.5e-3, 0.0),
    "d435": Sensor((640, 480), (80.0, 64.4), (0.2, 6.0), 5.3e-3, 0.050),
    "d415": Sensor((640, 480), (55.0, 42.7), (0.3, 8.0), 3.0e-3, 0.055),
}


def sensor_camera(name: str, height: float = 0.30, pitch: float = 0.0, roll: float = 0.0) -> Camera:
    """The camera of a sensor `height` [m] over the floor, pitched down and rolled to the right [rad]."""
    sensor = SENSORS[name]
    (width, height_px), (across, upright) = sensor.size, sensor.field_of_view
    fx = width / 2 / math.tan(math.radians(across) / 2)
    fy = height_px / 2 / math.tan(math.radians(upright) / 2)
    intrinsics = Intrinsics(fx, fy, (width - 1) / 2, (height_px - 1) / 2)
    floor = FloorPlane.from_mount(height, pitch, roll)
    return Camera(width, height_px, intrinsics, sensor.range, floor, sensor.noise, sensor.baseline)
