"""What a driver remembers of a floor plan that nobody showed it: where it was, what it saw, where the gate held it."""

from __future__ import annotations

import math
from collections import deque
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from benchmarks.falls.bases import Size
from benchmarks.falls.sight import SQUARE, Sight
from cliffscan.common.contract.messages import LaserScan
from cliffscan.simulator.world import Pose

SEEN = 0.45, 0.28  # [m] around the robot that counts as visited, in a first and in a second round
STOPPED = 0.15  # [m] around a place ahead of a robot that was held, where its middle cannot get to

Place = tuple[float, float]  # [m]
Square = tuple[int, int]
STEPS = ((1, 0), (0, 1), (-1, 0), (0, -1))


class Memory:
    """Squares of a floor plan between two corners [m]. Where nothing is known, the way is thought to be free."""

    def __init__(self, low: Place, high: Place, size: Size) -> None:
        self.low, self.high = low, high
        self._ahead = size.ahead
        shape = math.ceil((high[0] - low[0]) / SQUARE), math.ceil((high[1] - low[1]) / SQUARE)
        self._least = np.full(shape, math.inf)  # [m] how near it was; 0 for what was tried in vain
        self._round = 0
        self._shut = np.zeros(shape, dtype=bool)  # by the gate
        self._stood = np.zeros(shape, dtype=bool)  # where its middle was, so that it can be there
        self._sight = Sight(low, shape, size)
        x, y = (first + SQUARE * (0.5 + np.arange(count)) for first, count in zip(low, shape, strict=True))
        self._x, self._y = x[:, None], y[None, :]

    def visit(self, x: float, y: float) -> None:
        """The robot is there [m]."""
        np.minimum(self._least, np.hypot(self._x - x, self._y - y), out=self._least)
        here = self.square(x, y)
        self._stood[here], self._shut[here] = True, False

    def see(self, pose: Pose, scan: LaserScan) -> None:
        """A fused scan that was taken while the robot truly was at `pose`."""
        self._sight.see(pose, scan)

    def give_up(self, place: Place) -> None:
        """That place [m] was tried in vain."""
        self._least[self._around(*place, SQUARE)] = 0.0

    def shut(self, x: float, y: float, heading: float) -> None:
        """A robot there [m] could not go on that way [rad]."""
        self._shut |= self._around(x + self._ahead * math.cos(heading), y + self._ahead * math.sin(heading), STOPPED)
        self._shut[self.square(x, y)] = False

    def ways(self, start: Place) -> Ways:
        """Where it can get to over open squares, as far as it knows, and which of these places it has not visited."""
        first = self.square(*start)
        came: dict[Square, Square] = {first: first}
        ahead = deque([first])
        while ahead:
            square = ahead.popleft()
            for i, j in STEPS:
                following = square[0] + i, square[1] + j
                if following not in came and self._open(following):
                    came[following] = square
                    ahead.append(following)
        seen = SEEN[self._round]
        return Ways(self, came, [square for square in came if self._least[square] > seen])

    def begin_again(self) -> None:
        """Forget where the gate did not let it go, for another round; after the last one forget also where it was."""
        self._shut[:] = False
        self._round = (self._round + 1) % len(SEEN)
        if self._round == 0:
            self._least[:] = math.inf

    def straight(self, start: Place, end: Place) -> bool:
        """Whether no shut square lies between two places."""
        count = max(math.ceil(math.dist(start, end) / (SQUARE / 2)), 1)
        parts = (part / count for part in range(1, count + 1))
        points = ((start[0] + part * (end[0] - start[0]), start[1] + part * (end[1] - start[1])) for part in parts)
        return all(self._open(self.square(*point)) for point in points)

    def square(self, x: float, y: float) -> Square:
        """The square of a place; the nearest one for a place beyond."""
        i, j = math.floor((x - self.low[0]) / SQUARE), math.floor((y - self.low[1]) / SQUARE)
        rows, columns = self._shut.shape
        return min(max(i, 0), rows - 1), min(max(j, 0), columns - 1)

    def _open(self, square: Square) -> bool:
        rows, columns = self._shut.shape
        if not (0 <= square[0] < rows and 0 <= square[1] < columns):
            return False
        return not self._shut[square] and bool(self._stood[square] or not self._sight.shut[square])

    def _around(self, x: float, y: float, radius: float) -> NDArray[np.bool_]:
        near: NDArray[np.bool_] = (self._x - x) ** 2 + (self._y - y) ** 2 <= radius**2
        return near

    def place(self, square: Square) -> Place:
        """The middle of a square [m]."""
        return float(self._x[square[0], 0]), float(self._y[0, square[1]])


class Ways(NamedTuple):
    """Ways from where the robot is. came: from which square each one is got to, in the order of their distance."""

    memory: Memory
    came: dict[Square, Square]
    new: list[Square]

    def to(self, square: Square) -> list[Place]:
        """The way to a square, from near to far."""
        squares = [square]
        while self.came[squares[-1]] != squares[-1]:
            squares.append(self.came[squares[-1]])
        return [self.memory.place(each) for each in reversed(squares)]
