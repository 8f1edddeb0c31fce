"""How good a map is: functions of a map, poses and the truth, and nothing else."""

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from cliffscan.common.contract.base_messages import Triple
from cliffscan.common.contract.camera import Floats
from cliffscan.common.contract.map_messages import OccupancyGrid
from evaluation.truth.beam_truth import Mask
from evaluation.truth.world_truth import Ground, nearest
from examples.slam.map_files import FREE_UP_TO, OCCUPIED_FROM

DEFINITIONS = """\
- *free beyond*: area of the free cells that lie wholly where there is no floor,
  beyond an edge: where a planner would send the robot down.
- *blocked*: area of the occupied cells on the floor that are more than one cell
  from every edge and every obstacle: where the robot could go, and would not.
- *edges*: of the floor's sides that are a drop and that the camera had in view
  on this drive, unobstructed and within the mappers' reach, the share that has
  an occupied cell's centre within one cell (5 cm).
- *rms*, *final*: distance between the robot's place on the map and its true
  place, over all scans and at the last one.
"""


class MapScore(NamedTuple):
    """The measures of DEFINITIONS; NaN where there is nothing to take them over."""

    free_beyond: float  # [m²]
    blocked: float  # [m²]
    edges: float  # share
    rms: float  # [m]
    final: float  # [m]


class Faults(NamedTuple):
    """Which cells of a map are wrong: two of (height, width)."""

    free_beyond: Mask
    blocked: Mask


def centres(grid: OccupancyGrid) -> Floats:
    """The middle of every cell, row by row: (height * width, 2) [m]."""
    x = grid.origin[0] + (np.arange(grid.width) + 0.5) * grid.resolution
    y = grid.origin[1] + (np.arange(grid.height) + 0.5) * grid.resolution
    return np.column_stack([np.tile(x, grid.height), np.repeat(y, grid.width)])


def free(grid: OccupancyGrid) -> Mask:
    """Which cells `map_server` takes for free: (height * width,)."""
    found: Mask = (grid.data >= 0) & (grid.data <= FREE_UP_TO)
    return found


def occupied(grid: OccupancyGrid) -> Mask:
    """Which cells `map_server` takes for occupied: (height * width,)."""
    found: Mask = grid.data >= OCCUPIED_FROM
    return found


def faults(grid: OccupancyGrid, ground: Ground) -> Faults:
    """The cells of a map that mislead, by DEFINITIONS."""
    places = centres(grid)
    floor, standing = ground.inside("floor", places), ground.inside("obstacle", places)
    limits = np.concatenate([ground.edges, ground.obstacles()])
    beyond = free(grid) & ~floor & ~standing
    beyond[beyond] = nearest(places[beyond], ground.edges) >= grid.resolution / 2
    wrongly = occupied(grid) & floor & ~standing
    wrongly[wrongly] = nearest(places[wrongly], limits) > grid.resolution
    shape = grid.height, grid.width
    return Faults(beyond.reshape(shape), wrongly.reshape(shape))


def edges_shown(grid: OccupancyGrid, edges: Floats) -> Mask:
    """Which points of edges (n, 2) [m] have the centre of an occupied cell within one cell: (n,)."""
    found: Mask = nearest(edges, centres(grid)[occupied(grid)]) <= grid.resolution
    return found


def pose_errors(told: Mapping[int, Triple], true: Mapping[int, Triple]) -> Floats:
    """Distance [m] between two poses of the same stamp [ns], in order of time: (stamps,)."""
    stamps = sorted(told.keys() & true.keys())
    pairs = np.array([(told[stamp][:2], true[stamp][:2]) for stamp in stamps]).reshape(-1, 2, 2)
    errors: Floats = np.hypot(*(pairs[:, 0] - pairs[:, 1]).T)
    return errors


def score(grid: OccupancyGrid, ground: Ground, in_view: Floats, errors: Floats) -> MapScore:
    """The score of a map. in_view: points (n, 2) [m] of the edges that were in view; errors: of its poses (n,) [m]."""
    cell = grid.resolution**2
    wrong = faults(grid, ground)
    return MapScore(
        free_beyond=cell * int(wrong.free_beyond.sum()),
        blocked=cell * int(wrong.blocked.sum()),
        edges=float(edges_shown(grid, in_view).mean()) if len(in_view) else float("nan"),
        rms=float(np.sqrt((errors**2).mean())) if errors.size else float("nan"),
        final=float(errors[-1]) if errors.size else float("nan"),
    )
