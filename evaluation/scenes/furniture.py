"""What stands about: boxes, people, tables, railings and walls, put where there is floor and not on the robot."""

import math

import numpy as np

from cliffscan.common.contract.camera import Floats
from evaluation.scenes.polygons import contains, direction, rectangle
from evaluation.scenes.scene import TALL, Scene

Rng = np.random.Generator
CLEAR = 0.6  # [m] around the camera, where the robot is


def wall(scene: Scene, near: Floats, far: Floats, bottom: float = 0.0) -> None:
    """A wall of 10 cm between two points (2,) [m]."""
    along = far - near
    yaw = math.atan2(along[1], along[0])
    scene.stand(rectangle((near + far) / 2, float(np.hypot(*along)), 0.10, yaw), bottom, TALL)


def wall_beyond(scene: Scene, rng: Rng, heading: float, nearest: float, bottom: float = 0.0) -> None:
    """A long wall across the way, somewhere from `nearest` [m] on."""
    middle = direction(heading) * (nearest + 0.1 + rng.uniform(0.0, 3.0))
    across = direction(heading + math.pi / 2) * 9.0
    wall(scene, middle - across, middle + across, bottom)


def free_spot(scene: Scene, rng: Rng, radius: float, distances: tuple[float, float]) -> Floats | None:
    """A place (2,) [m] for something of that radius, in sight and on the floor; None where none was found."""
    for _ in range(30):
        spot = direction(rng.uniform(-0.55, 0.55)) * rng.uniform(*distances)
        far = float(np.hypot(*spot)) > CLEAR + radius
        if far and not any(contains(drop.outline, spot[None], 1.5 * radius).any() for drop in scene.drops):
            return spot
    return None


def box(scene: Scene, rng: Rng) -> None:
    """A box of some size, turned."""
    length, width = rng.uniform(0.05, 0.8, 2)
    spot = free_spot(scene, rng, float(np.hypot(length, width)) / 2, (0.9, 4.0))
    if spot is not None:
        scene.stand(rectangle(spot, length, width, rng.uniform(0, math.pi)), 0.0, rng.uniform(0.05, 1.2))


def person(scene: Scene, rng: Rng) -> None:
    """An upright cylinder of a person's size."""
    radius = rng.uniform(0.12, 0.25)
    spot = free_spot(scene, rng, radius, (1.0, 4.0))
    if spot is not None:
        scene.post(spot, radius, 0.0, rng.uniform(1.5, 1.9))


def table(scene: Scene, rng: Rng) -> None:
    """A table: four thin legs, and a top that is overhead for the robot."""
    length, width, yaw = rng.uniform(0.7, 1.6), rng.uniform(0.6, 0.9), rng.uniform(0, math.pi)
    spot = free_spot(scene, rng, float(np.hypot(length, width)) / 2, (1.2, 3.5))
    if spot is None:
        return
    height, radius = rng.uniform(0.68, 0.78), rng.uniform(0.015, 0.025)
    for leg in rectangle(spot, length - 0.1, width - 0.1, yaw):
        scene.post(leg, radius, 0.0, height)
    scene.stand(rectangle(spot, length, width, yaw), height, height + 0.03)


def railing(scene: Scene, rng: Rng, heading: float, distance: float) -> None:
    """Posts a metre or so apart, and two bars, across the way at that distance [m]."""
    across, middle = direction(heading + math.pi / 2), direction(heading) * distance
    spacing = rng.uniform(0.8, 1.5)
    for step in np.arange(-4, 5) * spacing + rng.uniform(0, spacing):
        scene.post(middle + across * step, 0.02, 0.0, 0.9)
    for height in (0.45, 0.88):
        scene.stand(rectangle(middle, 0.03, 9 * spacing, heading), height, height + 0.03)


def clutter(scene: Scene, rng: Rng, most: int) -> None:
    """Some boxes, people and tables."""
    for thing in rng.choice(np.array([box, box, person, table], dtype=object), rng.integers(0, most + 1)):
        thing(scene, rng)
