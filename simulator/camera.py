"""A simulated depth sensor, a Kinect by default, on a robot that stands in a world."""

import numpy as np

from cliffscan.common.contract.camera import Camera, check_camera
from cliffscan.simulator.faces import faces_of
from cliffscan.simulator.kinect import Image, KinectModel, Millimetres, SensorModel, kinect_camera, measure, returns
from cliffscan.simulator.rasteriser import depth_image
from cliffscan.simulator.world import Pose, World


class SimulatedKinect:
    """Depth images of a world by name, the same for the same seed. The scene stands still; robot and camera may move.

    Raises ValueError for an unknown world or an impossible camera.
    """

    def __init__(
        self, world: str, camera: Camera | None = None, model: SensorModel | None = None, seed: int = 0
    ) -> None:
        self.world = World(world)
        self.camera = camera or kinect_camera()
        self.model: SensorModel = model or KinectModel()
        check_camera(self.camera)
        self._faces = faces_of(self.world)
        self._rng = np.random.default_rng(seed)
        self._view: tuple[Pose, Camera] | None = None
        self._returns: Image = np.empty((0, 0), dtype=np.float32)

    def move(self, pose: Pose, camera: Camera | None = None) -> None:
        """Place the robot, and tilt its camera where one is given. Raises ValueError for an impossible camera."""
        if camera is not None:
            check_camera(camera)
            self.camera = camera
        self.world.pose = pose

    def depth(self) -> Image:
        """Exact depth [m] of what the camera sees now: (rows, cols), inf = nothing."""
        return depth_image(self._faces, *self.world.camera_pose(self.camera), self.camera)

    def frame(self) -> Millimetres:
        """The next image of the sensor: (rows, cols) [mm], 0 = no return."""
        view = (self.world.pose, self.camera)
        if view != self._view:  # while the view stays, only the noise differs from frame to frame
            self._returns = returns(self.depth(), self.camera, self.model)
            self._view = view
        return measure(self._returns, self.camera, self.model, self._rng)
