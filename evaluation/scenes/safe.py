"""Scenes in which a robot may drive on: whatever number a method reports there is false."""

import math

from cliffscan.simulator.faces import at
from evaluation.scenes.drops import HEADINGS, Span, halves
from evaluation.scenes.furniture import Rng, box, clutter, person, railing, table, wall, wall_beyond
from evaluation.scenes.polygons import clip, direction, rectangle
from evaluation.scenes.scene import GROUND, Ramp, Scene

ADA = math.tan(math.radians(4.76))  # 1 in 12
STEEPEST = 5.0  # [deg]
SILL = 0.015  # [m]
DRIVEN = 0.01  # [m] of a step
CRESTS = (2.8, 3.2)  # [m] ahead, of ramps whose surface is still seen
ROUGH = 0.01  # sine of the angle below which it is not


def ground() -> Scene:
    """Nothing but floor."""
    scene = Scene()
    scene.lay(GROUND)
    return scene


def open_floor(_rng: Rng, _edges: Span) -> Scene:
    """Floor as far as the sensor sees."""
    return ground()


def lost_returns(rng: Rng, _edges: Span) -> Scene:
    """A floor with some furniture, and a fifth of all pixels lost."""
    scene = ground()
    clutter(scene, rng, 3)
    scene.dropout = 0.2
    return scene


def walls(rng: Rng, _edges: Span) -> Scene:
    """One or two walls at any heading."""
    scene = ground()
    wall_beyond(scene, rng, rng.uniform(-1.0, 1.0), 0.9)
    if rng.random() < 0.5:
        wall_beyond(scene, rng, rng.uniform(-1.0, 1.0), 1.2)
    return scene


def corridor(rng: Rng, _edges: Span) -> Scene:
    """A narrow corridor that ends out of range, with a door or two in its sides."""
    scene = ground()
    yaw = rng.uniform(-0.35, 0.35)
    ahead = direction(yaw)
    for side in (-rng.uniform(0.5, 1.2), rng.uniform(0.5, 1.2)):
        aside = direction(yaw + math.pi / 2) * side
        door = rng.uniform(1.0, 4.0)
        wall(scene, aside - ahead, aside + ahead * door)
        wall(scene, aside + ahead * (door + rng.uniform(0.7, 1.0)), aside + ahead * 11.0)
    return scene


def boxes(rng: Rng, _edges: Span) -> Scene:
    """Boxes and people."""
    scene = ground()
    for _ in range(int(rng.integers(2, 7))):
        (person if rng.random() < 0.3 else box)(scene, rng)
    return scene


def tables(rng: Rng, _edges: Span) -> Scene:
    """Thin legs with tops overhead."""
    scene = ground()
    for _ in range(int(rng.integers(1, 4))):
        table(scene, rng)
    return scene


def railings(rng: Rng, _edges: Span) -> Scene:
    """A railing across the way, floor on both sides of it."""
    scene = ground()
    railing(scene, rng, rng.uniform(-0.9, 0.9), rng.uniform(0.9, 3.5))
    clutter(scene, rng, 2)
    return scene


def sill(rng: Rng, _edges: Span) -> Scene:
    """A doorway with a sill of up to 1.5 cm."""
    scene = ground()
    heading, distance, door = rng.uniform(-0.5, 0.5), rng.uniform(1.0, 3.0), rng.uniform(0.7, 1.1)
    middle, aside = direction(heading) * distance, direction(heading + math.pi / 2)
    for side in (-1.0, 1.0):
        wall(scene, middle + aside * side * door / 2, middle + aside * side * 8.0)
    scene.stand(rectangle(middle, rng.uniform(0.05, 0.12), door, heading), 0.0, rng.uniform(0.005, SILL))
    return scene


def driven_step(rng: Rng, edges: Span) -> Scene:
    """A straight edge, and a floor that goes on higher or lower by what every wheel takes."""
    scene = Scene()
    here, beyond = halves(rng.uniform(*HEADINGS), rng.uniform(*edges))
    scene.lay(here)
    scene.lay(beyond, rng.uniform(-DRIVEN, DRIVEN))
    return scene


def ramp_down(rng: Rng, edges: Span) -> Scene:
    """A ramp of up to 5° downward, then level floor."""
    return ramp(rng, edges, -1.0)


def ramp_up(rng: Rng, edges: Span) -> Scene:
    """A ramp of up to 5° upward, then level floor."""
    return ramp(rng, edges, 1.0)


def ramp(rng: Rng, edges: Span, sign: float) -> Scene:
    """A ramp at any heading, its start anywhere before the end of sight; a third of all are as steep as ADA allows."""
    heading = rng.uniform(-0.9, 0.9)
    slope = ADA if rng.random() < 0.33 else math.tan(math.radians(rng.uniform(1.0, STEEPEST)))
    start, length = rng.uniform(0.4, edges[1]), rng.uniform(0.5, 5.0)
    return inclined(Ramp(heading, start, length, sign * slope))


def ramp_ahead(rng: Rng, _edges: Span) -> Scene:
    """A ramp of 3 to 5° downward that begins far ahead, of a rough surface that returns light from any angle."""
    slope = math.tan(math.radians(rng.uniform(3.0, STEEPEST)))
    scene = inclined(Ramp(rng.uniform(-0.3, 0.3), rng.uniform(*CRESTS), 5.0, -slope))
    scene.grazing = ROUGH
    return scene


def inclined(ramp: Ramp) -> Scene:
    """Level floor, a ramp, and level floor behind it."""
    scene, normal = Scene(ramp=ramp), direction(ramp.heading)
    end = ramp.start + ramp.length
    here, beyond = halves(ramp.heading, ramp.start)
    scene.lay(here)
    incline = at(clip(beyond, normal, end), 0.0)
    incline[:, 2] = ramp.slope * (incline[:, :2] @ normal - ramp.start)
    scene.faces.append(incline)
    scene.lay(clip(beyond, -normal, -end), ramp.slope * ramp.length)
    return scene


def glossy(rng: Rng, _edges: Span) -> Scene:
    """Floor with patches from which no light returns: no single frame can tell one from a hole without bottom."""
    scene = ground()
    for _ in range(int(rng.integers(1, 4))):
        spot = direction(rng.uniform(-0.4, 0.4)) * rng.uniform(1.2, 3.5)
        length, width = rng.uniform(0.15, 1.0, 2)
        scene.glossy.append(rectangle(spot, length, width, rng.uniform(0, math.pi)))
    return scene
