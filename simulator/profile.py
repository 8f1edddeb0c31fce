"""The floor along beams: how it goes on, over ramps and under what stands on it, until it ends.

All surfaces are flat, so along a beam every height is a straight line between two breaks: where a piece of the scene
begins or ends, and where a ramp comes out of another piece. A walk goes from break to break, on all beams at once.
"""

import math
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from cliffscan.common.contract.camera import Floats
from cliffscan.simulator.footprints import Footprint
from cliffscan.simulator.world import Pose

Mask = NDArray[np.bool_]

FLUSH = 1e-3  # [m] steps and gaps up to this are floor
CLIMB = 0.01  # [m] a step on to a ramp's side, or off it, that wheels take
FAR = 1000.0  # [m] where the last interval ends
ROUNDING = 1e-9  # [m]


class Strips(NamedTuple):
    """Pieces of the scene along beams: where they begin and end, their height at the origin and their climb; (p, n).

    bottom, step: (p, 1) [m] their lowest point, and the step up or down to and from them that is none.
    """

    enter: Floats
    leave: Floats
    start: Floats
    climb: Floats
    bottom: Floats
    step: Floats

    def tops(self, distance: Floats) -> Floats:
        """Heights [m] of the upper sides at a distance (n,) [m]: (p, n)."""
        return self.start + self.climb * distance


def walk(pieces: list[Footprint], pose: Pose, angles: Floats, low: float, high: float) -> tuple[Floats, Floats]:
    """Distances [m] at which the floor ends by a drop, and at which something is low to high [m] over it: two of (n,).

    inf where there is none. angles: (n,) [rad] from the pose's heading.
    """
    strips = strips_of(pieces, pose, angles)
    walkers = Walkers(strips, np.full(len(angles), standing(pieces, pose)), low, high)
    at = breaks(strips)
    for begin, end in pairwise(at):
        if (begin < end).any():
            walkers.go(begin, end)
    return walkers.edge, walkers.blocked


class Walkers:
    """One on each beam (n,), on the floor or, past its end, at its last height."""

    def __init__(self, strips: Strips, floor: Floats, low: float, high: float) -> None:
        self.edge, self.blocked, self._gap = (np.full(len(floor), math.inf) for _ in range(3))
        self._strips, self._low, self._high = strips, low, high
        self._floor = floor  # [m]
        self._step = np.full(len(floor), FLUSH)  # [m] down from what the walker is on

    def go(self, begin: Floats, end: Floats) -> None:
        """From a break to the next one (n,) [m]; a walker stays where they are the same."""
        moved = begin < end
        middle = (begin + end) / 2
        present = (self._strips.enter <= middle) & (middle <= self._strips.leave)
        first, last = self._strips.tops(begin), self._strips.tops(end)
        reached = present & (first <= self._floor + self._strips.step)
        # the highest, in the middle of the way
        ground = np.argmax(np.where(reached, first + last, -math.inf), axis=0)[None]
        new_first, new_last, step = (
            np.take_along_axis(each, ground, axis=0)[0]
            for each in (first, last, np.broadcast_to(self._strips.step, first.shape))
        )
        carried = reached.any(axis=0) & (new_first >= self._floor - np.maximum(self._step, step))
        floor_first, floor_last = np.where(carried, [new_first, new_last], self._floor)
        self._meet(
            present & moved, first - floor_first, last - floor_last, begin, end, self._strips.bottom - floor_first
        )
        self._lose(moved & ~carried, moved & carried, begin, end)
        self._floor = np.where(moved, floor_last, self._floor)
        self._step = np.where(moved & carried, step, self._step)

    def _meet(self, present: Mask, first: Floats, last: Floats, begin: Floats, end: Floats, bottom: Floats) -> None:
        """Note where pieces of these heights over the floor [m] (p, n) are in the way."""
        low = self._low + ROUNDING
        share = np.divide(low - first, last - first, out=np.zeros_like(first), where=last > first)
        there = present & (bottom < self._high) & (np.maximum(first, last) > low)
        places = np.where(first > low, begin, begin + share * (end - begin))
        self.blocked = np.minimum(self.blocked, np.where(there, places, math.inf).min(axis=0, initial=math.inf))

    def _lose(self, lost: Mask, carried: Mask, begin: Floats, end: Floats) -> None:
        """Note where the floor ends; a gap that is over before it counts is none."""
        gap = np.where(lost & np.isinf(self._gap), begin, self._gap)
        self._gap = np.where(carried & (begin - gap <= FLUSH), math.inf, gap)
        self.edge = np.where(np.isinf(self.edge) & lost & (end - self._gap > FLUSH), self._gap, self.edge)


def strips_of(pieces: list[Footprint], pose: Pose, angles: Floats) -> Strips:
    """The pieces along beams from a pose. angles: (n,) [rad] from its heading."""
    origin, headings = np.array([pose.x, pose.y]), angles + pose.yaw
    crossings = [piece.crossing(origin, headings) for piece in pieces]
    heights = [piece.top_along(origin, headings) for piece in pieces]
    enter, leave = np.array(crossings).reshape(len(pieces), 2, len(angles)).swapaxes(0, 1)
    start, climb = np.array(heights).reshape(len(pieces), 2, len(angles)).swapaxes(0, 1)
    bottom = np.array([[piece.bottom] for piece in pieces])
    step = np.array([[CLIMB if piece.slope else FLUSH] for piece in pieces])
    return Strips(enter, leave, start, climb, bottom, step)


def breaks(strips: Strips) -> Floats:
    """Distances [m] between which heights are straight lines, in order, from 0 to FAR: (breaks, n)."""
    beams = strips.enter.shape[1]
    found = [np.zeros((1, beams)), strips.enter, strips.leave, np.full((1, beams), FAR)]
    for ramp in np.flatnonzero(strips.step[:, 0] > FLUSH):
        rise, approach = strips.start - strips.start[ramp], strips.climb[ramp] - strips.climb
        found.append(np.divide(rise, approach, out=np.zeros_like(rise), where=approach != 0.0))
    return np.sort(np.clip(np.concatenate(found), 0.0, FAR), axis=0)


def standing(pieces: list[Footprint], pose: Pose) -> float:
    """Height [m] of the floor under a pose: of the ramp or platform there, if any."""
    point = np.array(pose[:2])
    return max(
        (float(each.top_at(point)) for each in pieces if each.walkable and not each.distance(point)), default=0.0
    )
