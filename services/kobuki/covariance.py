"""How sure three numbers are that belong together: a symmetric matrix as plain numbers.

At 50 steps a second arrays of nine would cost ten times as much.
"""

from __future__ import annotations

from operator import add
from typing import NamedTuple


class Covariance(NamedTuple):
    """Of x, y and an angle t, or of their velocities: the upper triangle of the (3, 3) matrix, row by row."""

    xx: float = 0.0
    xy: float = 0.0
    xt: float = 0.0
    yy: float = 0.0
    yt: float = 0.0
    tt: float = 0.0

    @classmethod
    def of_deviations(cls, x: float, y: float, t: float) -> Covariance:
        """Of three numbers that have nothing to do with one another, by their standard deviations."""
        return cls(xx=x * x, yy=y * y, tt=t * t)

    def plus(self, other: Covariance) -> Covariance:
        """Of the sum with something independent."""
        return Covariance(*map(add, self, other))

    def moved(self, dx: float, dy: float) -> Covariance:
        """Of a pose after a motion by exactly (dx, dy) [m]: an error of the heading swings it round.

        J·P·Jᵀ with J = [[1, 0, -dy], [0, 1, dx], [0, 0, 1]].
        """
        xx, xy, xt, yy, yt, tt = self
        new_xt, new_yt = xt - dy * tt, yt + dx * tt
        return Covariance(
            xx - dy * (xt + new_xt), xy + dx * xt - dy * new_yt, new_xt, yy + dx * (yt + new_yt), new_yt, tt
        )

    def rows(self) -> list[float]:
        """All nine numbers, row by row."""
        xx, xy, xt, yy, yt, tt = self
        return [xx, xy, xt, xy, yy, yt, xt, yt, tt]
