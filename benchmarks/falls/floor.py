"""The floor of a world as it truly is: where the robot's disc can be, and where it can get to from its start.

A raster of the floor plan. Obstacles are at their exact distance; where the floor ends, or rises or falls by a step
that wheels do not take, is told to half a cell.
"""

import math
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from cliffscan.common.contract.camera import Floats
from cliffscan.simulator.footprints import footprints
from cliffscan.simulator.truth import kind
from cliffscan.simulator.world import Pose, World
from evaluation.truth.beam_truth import Mask

CELL = 0.05  # [m]
RADIUS = 0.18  # [m] of a TurtleBot 2
ROOM = 0.08  # [m] between disc and obstacle or edge that the gate keeps at the most: its margin and its own cells
STEP = 0.012  # [m] up or down from one cell to the next that ends the floor: a ramp of 5 degrees has 4 mm
NEAR = 0.30  # [m] within which a place counts as visited


class Floor:
    """Where a robot can be in a world. Masks are (rows along x, columns along y), of places of the disc's middle."""

    def __init__(self, world: World, radius: float = RADIUS) -> None:
        self._radius = radius
        self._pieces = footprints(world)
        walls = np.concatenate([piece.outline() for piece in self._pieces if kind(piece) == "obstacle"])
        self.low, self.high = walls.min(axis=0), walls.max(axis=0)  # [m] corners of the floor plan
        counts = np.ceil((self.high - self.low) / CELL).astype(int)
        along_x, along_y = (low + CELL * (0.5 + np.arange(n)) for low, n in zip(self.low, counts, strict=True))
        self._middles = np.stack(np.meshgrid(along_x, along_y, indexing="ij"), axis=-1)  # (rows, columns, 2) [m]

    @cached_property
    def free(self) -> Mask:
        """Where the disc stands on floor and touches nothing."""
        return self._clear(self._radius)

    @cached_property
    def roomy(self) -> Mask:
        """Where it stands so that the gate has no cause to hold it."""
        return self._clear(self._radius + ROOM)

    @cached_property
    def reachable(self) -> Mask:
        """Where the disc can get to from the world's start."""
        reached = self.mask(np.zeros((1, 2)))
        while True:
            grown = dilated(reached, 1.0) & self.free
            if (grown == reached).all():
                return reached
            reached = grown

    @property
    def area(self) -> float:
        """Of the reachable places [m²]."""
        return CELL**2 * float(self.reachable.sum())

    def visited(self, track: Floats) -> float:
        """Share of the reachable places that a track (n, 2) [m] comes within NEAR of."""
        met = dilated(self.mask(track), NEAR / CELL)
        return float((met & self.reachable).sum() / self.reachable.sum())

    def mask(self, points: Floats) -> Mask:
        """The cells of points (n, 2) [m]."""
        cells = np.zeros(self._middles.shape[:2], dtype=bool)
        cells[self._places(points)] = True
        return cells

    def clear(self, points: Floats) -> bool:
        """Whether the disc has room at all of these points (n, 2) [m]."""
        return bool(self.roomy[self._places(points)].all())

    def _places(self, points: Floats) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """Rows and columns of the cells of points (n, 2) [m]; those beyond the plan are taken for its border."""
        cells = np.floor((points - self.low) / CELL).astype(np.int64)
        row, column = np.clip(cells, 0, np.array(self._middles.shape[:2]) - 1).T
        return row, column

    def _clear(self, radius: float) -> Mask:
        far = ~dilated(self._ends, radius / CELL)
        for piece in self._pieces:
            if kind(piece) == "obstacle":
                far &= piece.distance(self._middles) >= radius
        return far

    @cached_property
    def _ends(self) -> Mask:
        """Cells without floor, and those at a step."""
        heights = np.full(self._middles.shape[:2], -math.inf)
        for piece in self._pieces:
            if kind(piece) == "floor":
                inside = piece.distance(self._middles) <= 0.0
                heights = np.where(inside, np.maximum(heights, piece.top_at(self._middles)), heights)
        ends = np.isneginf(heights)
        level = np.where(ends, -1.0, heights)
        down, across = (np.abs(np.diff(level, axis=axis)) > STEP for axis in (0, 1))
        ends[1:] |= down
        ends[:-1] |= down
        ends[:, 1:] |= across
        ends[:, :-1] |= across
        return ends


def dilated(mask: Mask, cells: float) -> Mask:
    """All within that many cells of the mask."""
    reach = int(cells)
    padded, grown = np.pad(mask, reach), np.zeros_like(mask)
    rows, columns = mask.shape
    for dx in range(-reach, reach + 1):
        for dy in range(-reach, reach + 1):
            if dx * dx + dy * dy <= cells * cells:
                grown |= padded[reach + dx : reach + dx + rows, reach + dy : reach + dy + columns]
    return grown


def arc(pose: Pose, linear: float, angular: float, length: float) -> Floats:
    """Points (n, 2) [m], a cell apart, that a robot comes to on an arc of that length [m]."""
    way = np.arange(0.0, length + CELL / 2, CELL) * math.copysign(1.0, linear)
    turned = pose.yaw + way * (angular / linear) / 2
    chord = way * np.sinc(way * (angular / linear) / (2 * math.pi))
    return np.array([pose.x, pose.y]) + np.stack([chord * np.cos(turned), chord * np.sin(turned)], axis=1)
