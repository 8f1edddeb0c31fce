"""The kernel of common/perception/low_steps.py, slowly and plainly, one line at a time.

Arithmetic is in single precision and in the kernel's order, so that both decide alike.
"""

from typing import NamedTuple

import numpy as np

from cliffscan.common.perception import low_steps as of_steps
from cliffscan.common.perception.low_steps import Sight

f32 = np.float32
RISE, FALL = 1, -1


class Candidate(NamedTuple):
    """What may be a step: which way, in which row and how far away it shows first, and how many points show it."""

    way: int
    row: int
    distance: f32
    points: int


class Step(NamedTuple):
    """A step, the last row of the floor before it, and the floor's height there."""

    way: int
    row: int
    before: int
    level: f32
    distance: f32


def first_step(heights: np.ndarray, distances: np.ndarray, sight: Sight) -> Step | None:
    """The first step along a line, whose points (rows,) are given from the robot outward."""
    line = Line(sight)
    for row, (height, distance) in enumerate(zip(heights, distances, strict=True)):
        if np.isnan(height) or distance > sight.reach:
            continue
        if line.level is None:
            if abs(height) <= of_steps.STRANGE:
                line.start(row, height, distance)
            continue
        if step := line.look(row, height, distance):
            return step
    return None


class Line:
    """The floor along a line, as far as it was followed."""

    def __init__(self, sight: Sight) -> None:
        self.sight = sight
        self.level: f32 | None = None
        self.candidate: Candidate | None = None
        self.rough = f32(0)
        self.broken = False

    def start(self, row: int, height: f32, distance: f32) -> None:
        """The floor comes into view."""
        self.level = f32(0) + height
        self.whole = abs(height) <= self.sight.step  # else it is the top of a thing
        self.before, self.far, self.last, self.run_from = row, distance, distance, distance

    def look(self, row: int, height: f32, distance: f32) -> Step | None:
        """A point farther on; a step where it proves one."""
        changed = height - self.level
        least = self.least(distance)
        if self.lasts(changed, least):
            self.candidate = self.candidate._replace(points=self.candidate.points + 1)
            way, first, start, points = self.candidate
            self.last = distance
            if points >= of_steps.ROWS and distance - start >= of_steps.LENGTH:
                return Step(way, first, self.before, self.level, start)
        elif self.begins(changed, least, height, distance):
            self.candidate = Candidate(RISE if changed > 0 else FALL, row, distance, 1)
            self.last = distance
        else:
            self.candidate = None
            self.follow(row, changed, least, distance)
        return None

    def least(self, distance: f32) -> f32:
        """By how much a height must change [m]."""
        slant = np.sqrt(distance * distance + self.sight.camera_height * self.sight.camera_height)
        return max(self.sight.step, self.sight.uncertain * slant, of_steps.ROUGH * self.rough)

    def lasts(self, changed: f32, least: f32) -> bool:
        """Whether the candidate is seen once more."""
        if not self.candidate or changed > of_steps.HIGH:
            return False
        return bool(changed * f32(self.candidate.way) > of_steps.LASTING * least)

    def begins(self, changed: f32, least: f32, height: f32, distance: f32) -> bool:
        """Whether the height changes here at once, after floor enough."""
        run = self.far - self.run_from
        if abs(changed) <= least or changed > of_steps.HIGH or run < of_steps.RUN:
            return False
        if changed > 0:
            return bool(distance - self.far <= of_steps.SHARP_RISE)
        above = self.sight.camera_height
        grazed = distance * (above - self.level) / (above - height)
        long = run >= of_steps.RUN_BEFORE_FALL or self.whole
        return bool(long and grazed - self.far <= of_steps.SHARP_FALL)

    def follow(self, row: int, changed: f32, least: f32, distance: f32) -> None:
        """The floor goes on, and its level with it, by no more than the steepest floor rises or falls."""
        further = max(distance - self.last, f32(0))
        may = self.sight.slope * further
        still = abs(changed) <= of_steps.STILL * least
        if still:
            share = min(further / of_steps.ROUGH_LENGTH, f32(1))
            self.rough = self.rough + share * (abs(changed) - self.rough)
            self.before, self.far = row, distance
            if self.broken:
                self.run_from, self.broken = distance, False
        else:
            self.whole, self.broken = False, True
        self.level = self.level + min(max(of_steps.GAIN * changed, -may), may)
        self.last = distance
