"""How long a simulated frame takes, beside MuJoCo's own rays: python -m benchmarks.simulator_rate [--frames N]."""

import argparse
from collections.abc import Callable
from statistics import median
from time import perf_counter

import mujoco
import numpy as np

from cliffscan.common.contract.camera import Camera
from cliffscan.simulator.camera import SimulatedKinect
from cliffscan.simulator.faces import faces_of
from cliffscan.simulator.kinect import measure, returns
from cliffscan.simulator.rasteriser import depth_image
from cliffscan.simulator.world import SCENE, Pose, World
from cliffscan.simulator.world_names import world_names


def milliseconds(work: Callable[[], object], times: int) -> float:
    """Median time [ms] of some calls, after one to compile."""
    work()
    taken = []
    for _ in range(times):
        start = perf_counter()
        work()
        taken.append(perf_counter() - start)
    return 1000.0 * median(taken)


def rays(world: World, camera: Camera) -> Callable[[], object]:
    """The same depth image by one call of mj_multiRay."""
    position, rotation = world.camera_pose(camera)
    fx, fy, cx, cy = camera.intrinsics
    u, v = np.meshgrid(np.arange(camera.width), np.arange(camera.height))
    directions = (
        np.stack([(u - cx) / fx, (v - cy) / fy, np.ones(u.shape)], axis=-1).reshape(-1, 3) @ rotation.T
    ).ravel()
    distance, geom = np.empty(u.size), np.empty(u.size, np.int32)
    group = (np.arange(6) == SCENE).astype(np.uint8)
    return lambda: mujoco.mj_multiRay(
        world.model, world.data, position, directions, group, True, -1, geom, distance, None, u.size, 1e6
    )


def timings(name: str, frames: int) -> list[float]:
    """Times [ms] in a world: rasterise, lose returns, add noise, a frame at rest, a frame in motion, mj_multiRay."""
    kinect = SimulatedKinect(name)
    world, camera, model = kinect.world, kinect.camera, kinect.model
    rng = np.random.default_rng(0)
    faces = faces_of(world)
    depth = kinect.depth()
    inverse = returns(depth, camera, model)
    yaws = iter(np.linspace(-0.2, 0.2, frames + 1))

    def in_motion() -> None:
        kinect.move(Pose(yaw=next(yaws)))
        kinect.frame()

    return [
        milliseconds(lambda: depth_image(faces, *world.camera_pose(camera), camera), frames),
        milliseconds(lambda: returns(depth, camera, model), frames),
        milliseconds(lambda: measure(inverse, camera, model, rng), frames),
        milliseconds(kinect.frame, frames),
        milliseconds(in_motion, frames),
        milliseconds(rays(world, camera), max(3, frames // 40)),
    ]


def main() -> None:
    """Print a line of median times for each world."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--frames", type=int, default=200, help="frames to take the median of")
    frames = parser.parse_args().frames
    print("median ms of a 640 x 480 frame on one core; the rate is that of a robot in motion")
    columns = ("rasterise", "returns", "noise", "at rest", "moving", "multiRay", "rate")
    print(f"{'world':<18}" + "".join(f"{column:>10}" for column in columns))
    for name in world_names():
        times = timings(name, frames)
        print(f"{name:<18}" + "".join(f"{time:>10.2f}" for time in times) + f"{1000.0 / times[4]:>7.0f} Hz")


if __name__ == "__main__":
    main()
