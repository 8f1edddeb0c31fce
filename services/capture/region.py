"""Which pixels can carry a return at all, learnt from pictures: depth registered to colour has none in its last rows.

+-----------------------+      The box holds all pixels that ever returned anything. A side of it is the sensor's
|   . . . . . . . . .   |      border, and no hole right before the robot, if it is the same in views that differ:
|   .     box       .   |      a hole's far side moves in the image when the robot moves. In each of these views
|   . . . . . . . . .   |      the box must be full along that side. A return beyond it takes it back at once.
+-----------------------+
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from cliffscan.common.contract.camera import Region

Depth = NDArray[np.uint16]
Flags = NDArray[np.bool_]
Grid = NDArray[np.int64]

VIEWS = 3
WIDEST = 8  # a border is at most this part of the image
BESIDE = 60  # and the strip inside it, that must be full of returns, this part
FULL = 0.7  # share of a strip's length with returns from which on it is full
CELLS = 6, 8  # rows and columns of the grid by which views are compared
SAMPLES = 6  # rows and columns of pixels that are looked at in each cell
CHANGED = 0.05  # relative difference of depth of a cell that has changed
MOST = 0.5  # share of the cells in which views must differ


class RegionLearner:
    """Learns the region of one sensor from its pictures. Its cost ends where every row and column has returned.

    views: mutually different ones in which a border must be the same; 1 where somebody knows that there is no hole.
    """

    def __init__(self, views: int = VIEWS) -> None:
        self._needed = views
        self._sides: list[_Side] = []
        self._shape = 0, 0

    def update(self, depth: Depth) -> Region | None:
        """The pixels that can carry a return, after one more picture (rows, columns) [mm]; None while all may."""
        if depth.shape != self._shape:
            self._shape = rows, columns = depth.shape[0], depth.shape[1]
            self._sides = [_Side(size, self._needed) for size in (columns, rows, columns, rows)]
        if not any(side.margin for side in self._sides):
            return None
        turned = [depth.T, depth, depth.T[::-1], depth[::-1]]  # each side on top
        for side, picture in zip(self._sides, turned, strict=True):
            side.grow(picture)
        view: Grid | None = None
        for place, (side, picture) in enumerate(zip(self._sides, turned, strict=True)):
            first, last = (self._sides[each].margin for each in ((place + 1) % 2, (place + 1) % 2 + 2))
            if side.open and side.full(picture[:, first : picture.shape[1] - last]):
                view = grid(depth) if view is None else view
                side.learn(view)
        left, top, right, bottom = (side.border for side in self._sides)
        if not (left or top or right or bottom):
            return None
        rows, columns = self._shape
        return Region(left, top, columns - 1 - right, rows - 1 - bottom)


class _Side:
    """One side of the image, on top in the pictures that are given. size: [px] rows of these; needed: views."""

    def __init__(self, size: int, needed: int) -> None:
        self._size, self._needed = size, needed
        self.margin = size  # rows that have never returned anything
        self._views: list[Grid] = []

    @property
    def open(self) -> bool:
        """Whether more views may show that this side's margin is a border."""
        return 0 < self.margin <= self._size // WIDEST and len(self._views) < self._needed

    @property
    def border(self) -> int:
        """Rows that cannot carry a return."""
        return self.margin if len(self._views) == self._needed else 0

    def grow(self, picture: Depth) -> None:
        """Take in where a picture has returns."""
        rows = picture[: self.margin].any(axis=1)
        if rows.any():
            self.margin = int(rows.argmax())
            self._views.clear()

    def full(self, picture: Depth) -> bool:
        """Whether a picture has returns along the margin, over most of its length."""
        strip = picture[self.margin : self.margin + max(self._size // BESIDE, 1)]
        return float(strip.any(axis=0).mean()) >= FULL

    def learn(self, view: Grid) -> None:
        """Note that the margin was empty and full beside in a view."""
        if all(differ(view, each) for each in self._views):
            self._views.append(view)


def grid(depth: Depth) -> Grid:
    """The median depth [mm] of each cell of an image, CELLS; 0 where fewer than half of its pixels have any."""
    (down, across), (rows, columns) = CELLS, depth.shape
    v, u = (
        ((np.arange(cells * SAMPLES) + 0.5) * size / (cells * SAMPLES)).astype(np.intp)
        for cells, size in ((down, rows), (across, columns))
    )
    cells = depth[np.ix_(v, u)].reshape(down, SAMPLES, across, SAMPLES).transpose(0, 2, 1, 3).reshape(down, across, -1)
    count = np.count_nonzero(cells, axis=-1)
    middle = cells.shape[-1] - 1 - count // 2
    median = np.take_along_axis(np.sort(cells, axis=-1), middle[..., None], axis=-1)[..., 0]
    return np.where(2 * count >= cells.shape[-1], median, 0).astype(np.int64)


def differ(one: Grid, other: Grid) -> bool:
    """Whether two views are of different places: in most cells both see something, and not at the same depth."""
    seen = (one > 0) & (other > 0)
    changed = seen & (np.abs(one - other) > CHANGED * np.minimum(one, other))
    return bool(np.count_nonzero(changed) > MOST * changed.size)
