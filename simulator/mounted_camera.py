"""A depth camera on a robot's body, which nods and leans with it."""

import math

import numpy as np

from cliffscan.common.contract.camera import Camera, Floats, FloorPlane, axes, check_camera
from cliffscan.simulator.body import Body
from cliffscan.simulator.faces import faces_of
from cliffscan.simulator.kinect import Image, Millimetres, SensorModel, sense
from cliffscan.simulator.rasteriser import depth_image
from cliffscan.simulator.world import Pose, World


class MountedCamera:
    """A camera, at its nominal mount, on a body in a world, x [m] ahead of the middle between the wheels.

    seed: of the sensor's noise. Raises ValueError for an impossible camera.
    """

    def __init__(self, world: World, body: Body, camera: Camera, sensor: SensorModel, x: float, seed: int) -> None:
        check_camera(camera)
        self.camera, self.sensor, self.x = camera, sensor, x
        self._body = body
        self._faces = faces_of(world)
        self._rng = np.random.default_rng(seed)

    def depth(self) -> Image:
        """Exact depth [m] of what the camera sees now: (rows, cols), inf = nothing."""
        return depth_image(self._faces, *self.camera_pose(), self.camera)

    def frame(self) -> Millimetres:
        """What the sensor sees now: (rows, cols) [mm], 0 = no return."""
        return sense(self.depth(), self.camera, self.sensor, self._rng)

    def camera_pose(self) -> tuple[Floats, Floats]:
        """The camera's true position (3,) [m] in the world, and rotation (3, 3) to it from its optical frame."""
        body = self._body
        position = body.position + body.rotation @ np.array([self.x, 0.0, self.camera.floor.d])
        return position, body.rotation @ np.stack(axes(self.camera.floor))

    def viewpoint(self) -> Pose:
        """Where scans are taken from: the floor below the camera, heading along its optical axis."""
        (x, y, _), rotation = self.camera_pose()
        return Pose(float(x), float(y), math.atan2(rotation[1, 2], rotation[0, 2]))

    def floor(self) -> FloorPlane:
        """The plane z = 0 as the camera truly stands over it: what a floor tracker should find on a level floor."""
        position, rotation = self.camera_pose()
        nx, ny, nz = rotation[2].tolist()
        return FloorPlane(nx, ny, nz, float(position[2]))
