"""Depth frames of a simulated sensor in one of the simulator's worlds."""

import math
import time

from cliffscan.common.contract.camera import Camera
from cliffscan.common.runtime.config import ConfigError
from cliffscan.services.capture.config import CaptureConfig
from cliffscan.services.capture.sources.depth_source import DepthFrame, Source
from cliffscan.services.capture.sources.simulation import Simulation
from cliffscan.simulator.camera import SimulatedKinect
from cliffscan.simulator.kinect import SensorModel
from cliffscan.simulator.sensor_models import MODELS
from cliffscan.simulator.sensors import sensor_camera


def open_configured(config: CaptureConfig) -> Source:
    """The camera of a running simulation where one is configured, or else one that stands still in a world.

    Raises SourceLost, ConfigError.
    """
    if config.simulation:
        return Simulation(config.simulation, config.mounted_floor())
    camera = sensor_camera(config.sensor, config.height, math.radians(config.pitch), math.radians(config.roll))
    return Simulated(config.world, camera, MODELS[config.sensor], config.rate, config.seed)


class Simulated:
    """Looks into `world` from its start, `rate` [Hz] times a second. Raises ConfigError for an unknown world.

    A frame that takes longer than its period is not made up for: the rate falls, and the service's status shows it.
    """

    def __init__(self, world: str, camera: Camera, model: SensorModel, rate: float, seed: int) -> None:
        try:
            self._kinect = SimulatedKinect(world, camera, model, seed)
        except ValueError as error:
            raise ConfigError(f"capture.world: {error}") from error
        self._kinect.frame()  # compiles
        self._period = 1.0 / rate
        self._due = time.monotonic()

    def read(self, timeout: float) -> DepthFrame | None:
        """The next frame when its time has come, stamped with the moment it shows."""
        wait = self._due - time.monotonic()
        time.sleep(min(max(wait, 0.0), timeout))
        if wait > timeout:
            return None
        self._due = max(self._due + self._period, time.monotonic())
        stamp = time.time_ns()
        return DepthFrame(self._kinect.frame(), stamp, self._kinect.camera)

    def close(self) -> None:
        """Nothing is held."""
