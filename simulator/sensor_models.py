"""The model of each sensor by name."""

from cliffscan.simulator.kinect import KinectModel, SensorModel
from cliffscan.simulator.sensors import SENSORS
from cliffscan.simulator.stereo import StereoModel
from cliffscan.simulator.time_of_flight import TimeOfFlightModel


def stereo(name: str, step: float) -> StereoModel:
    """A stereo camera. step: [1/m] 1/32 px of disparity."""
    return StereoModel(noise=SENSORS[name].noise, step=step, baseline=SENSORS[name].baseline)


MODELS: dict[str, SensorModel] = {
    "kinect": KinectModel(),
    "kinect_v2": TimeOfFlightModel(noise=0.0020),
    "azure_kinect": TimeOfFlightModel(noise=0.0015),
    "d435": stereo("d435", 1.64e-3),
    "d415": stereo("d415", 0.92e-3),
}
