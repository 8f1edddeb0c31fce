"""Scenes in which the floor ends: holes, kerbs, platforms and stairs. Each takes the camera's reach of edges [m]."""

import math

import numpy as np

from cliffscan.common.contract.camera import Floats
from evaluation.scenes.furniture import Rng, clutter, railing, wall, wall_beyond
from evaluation.scenes.polygons import clip, direction, rectangle
from evaluation.scenes.scene import GROUND, Drop, Scene

Span = tuple[float, float]

HEADINGS = (-0.9, 0.9)  # [rad] of the normal of a straight edge
STEPS = 12  # of a flight of stairs
LOW_STEPS, LOW_STEP_REACH = (0.014, 0.025), 1.5  # [m] of height, and how far away at most


def hole(rng: Rng, edges: Span) -> Scene:
    """A hole of some convex shape, size and depth, with furniture about it."""
    scene = Scene()
    outline = placed(random_outline(rng), direction(rng.uniform(-0.4, 0.4)), rng.uniform(*edges))
    depth = math.exp(rng.uniform(math.log(0.05), math.log(4.0)))
    dig(scene, rng, outline, depth)
    clutter(scene, rng, 3)
    if rng.random() < 0.4:
        wall_beyond(scene, rng, 0.0, float(outline[:, 0].max()) + 0.3)
    return scene


def dig(scene: Scene, rng: Rng, outline: Floats, depth: float) -> None:
    """A hole as a shaft with a bottom, one that is too deep for it to be seen, or through a slab."""
    style = rng.choice(["shaft", "bottomless", "room below", "void below"], p=[0.4, 0.15, 0.25, 0.2])
    slab = min(rng.uniform(0.05, 0.20), depth)
    scene.cut(outline, math.inf if style in ("bottomless", "void below") else depth)
    scene.line(outline, -depth if style == "shaft" else -4.0 if style == "bottomless" else -slab)
    if style == "shaft":
        scene.lay(outline, -depth)
    elif style == "room below":
        scene.lay(GROUND, -depth)


def random_outline(rng: Rng) -> Floats:
    """A rectangle or a convex polygon of 3 to 8 corners, 0.2 to 3 m long, turned, around the origin."""
    size = math.exp(rng.uniform(math.log(0.25), math.log(3.0)))
    slimness, yaw = rng.uniform(0.5, 1.0), rng.uniform(0.0, math.pi)
    if rng.random() < 0.4:
        return rectangle(np.zeros(2), size, slimness * size, yaw)
    count = int(rng.integers(3, 9))
    around = 2 * math.pi * (np.arange(count) + rng.uniform(-0.35, 0.35, count)) / count
    oval = np.column_stack([np.cos(around), slimness * np.sin(around)]) * size / 2
    ahead, aside = direction(yaw), direction(yaw + math.pi / 2)
    turned: Floats = oval[:, :1] * ahead + oval[:, 1:] * aside
    return turned


def placed(outline: Floats, towards: Floats, distance: float) -> Floats:
    """An outline moved in a direction until its nearest corner is `distance` [m] along it."""
    return outline + towards * (distance - float((outline @ towards).min()))


def halves(heading: float, edge: float) -> tuple[Floats, Floats]:
    """The ground on this and on the other side of a straight line at `edge` [m] along a heading."""
    normal = direction(heading)
    return clip(GROUND, normal, edge), clip(GROUND, -normal, -edge)


def kerb(rng: Rng, edges: Span) -> Scene:
    """A straight edge, and a floor that goes on 4 to 20 cm lower."""
    return step_down(rng, edges, rng.uniform(0.04, 0.20))


def kerb_5cm(rng: Rng, edges: Span) -> Scene:
    """A kerb of exactly 5 cm, near."""
    return step_down(rng, (edges[0], max(edges[0] + 0.1, min(edges[1], 1.5))), 0.05)


def low_step(rng: Rng, edges: Span) -> Scene:
    """A straight edge, near, and a floor that goes on lower by what no wheel takes, though it is less than a kerb."""
    return step_down(rng, (edges[0], min(edges[1], LOW_STEP_REACH)), rng.uniform(*LOW_STEPS))


def step_down(rng: Rng, edges: Span, depth: float) -> Scene:
    """A straight edge at any heading, and a floor that goes on `depth` [m] lower."""
    scene, heading, edge = Scene(), rng.uniform(*HEADINGS), rng.uniform(*edges)
    here, beyond = halves(heading, edge)
    scene.lay(here)
    scene.lay(beyond, -depth)
    scene.drops.append(Drop(beyond, depth))
    clutter(scene, rng, 2)
    if rng.random() < 0.4:
        wall_beyond(scene, rng, heading, edge + 0.4, -depth)
    return scene


def platform(rng: Rng, edges: Span) -> Scene:
    """The edge of a platform or a table top: far below it another floor, or nothing; perhaps a railing before it."""
    scene, heading, edge = Scene(), rng.uniform(*HEADINGS), rng.uniform(*edges)
    here, beyond = halves(heading, edge)
    depth = rng.uniform(0.3, 4.0)
    scene.lay(here)
    if bottom := rng.random() < 0.6:
        scene.lay(GROUND, -depth)
    scene.drops.append(Drop(beyond, depth if bottom else math.inf))
    clutter(scene, rng, 2)
    if rng.random() < 0.4 and edge > 1.0:
        railing(scene, rng, heading, edge - rng.uniform(0.05, 0.15))
    if rng.random() < 0.4:
        wall_beyond(scene, rng, heading, edge + 0.4, -depth)
    return scene


def stairs(rng: Rng, edges: Span) -> Scene:
    """Stairs down over the whole width, perhaps between walls, and a landing with or without a wall behind it."""
    scene, heading, edge = Scene(), rng.uniform(*HEADINGS), rng.uniform(*edges)
    here, beyond = halves(heading, edge)
    scene.lay(here)
    rise, tread = rng.uniform(0.15, 0.19), rng.uniform(0.25, 0.32)
    steps = int(rng.integers(2, STEPS))
    flight(scene, beyond, heading, (edge, rise, tread), steps)
    scene.drops.append(Drop(beyond, rise))
    landing = edge + (steps - 1) * tread
    if rng.random() < 0.5:
        flank(scene, rng, heading, -steps * rise)
    if rng.random() < 0.5:
        wall_beyond(scene, rng, heading, landing + 0.8, -steps * rise)
    return scene


def stairwell(rng: Rng, edges: Span) -> Scene:
    """Stairs down through an opening in the floor, with the walls of a shaft around them, seen from any side."""
    scene, heading = Scene(), rng.uniform(*HEADINGS) if rng.random() < 0.7 else rng.uniform(-math.pi, math.pi)
    rise, tread = rng.uniform(0.15, 0.19), rng.uniform(0.25, 0.32)
    steps = int(rng.integers(6, STEPS))
    towards, edge = direction(rng.uniform(-0.3, 0.3)), rng.uniform(*edges)
    opening = placed(rectangle(np.zeros(2), steps * tread, rng.uniform(0.8, 2.0), heading), towards, edge)
    scene.cut(opening, rise)
    scene.line(opening, -steps * rise)
    first = float((opening @ direction(heading)).min())
    flight(scene, opening, heading, (first, rise, tread), steps)
    clutter(scene, rng, 2)
    return scene


def flight(scene: Scene, area: Floats, heading: float, step: tuple[float, float, float], steps: int) -> None:
    """The treads within an area; the last goes on as the landing. step: the first edge, the rise and the tread [m]."""
    edge, rise, tread = step
    normal = direction(heading)
    for number in range(1, steps + 1):
        start = edge + (number - 1) * tread
        strip = clip(area, -normal, -start)
        scene.lay(strip if number == steps else clip(strip, normal, start + tread), -number * rise)


def flank(scene: Scene, rng: Rng, heading: float, bottom: float) -> None:
    """Walls on both sides of the way along a heading."""
    ahead, aside = direction(heading) * 9.0, direction(heading + math.pi / 2)
    for side in (rng.uniform(0.6, 1.5), -rng.uniform(0.6, 1.5)):
        wall(scene, aside * side - ahead / 9.0, aside * side + ahead, bottom)
