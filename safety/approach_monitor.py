"""Whether what the camera sees comes nearer as fast as the odometry says that the robot drives.

Wheels that slip all the time, or an encoder that counts half, report less than the way. The scans hold the truth: two
of them, some way apart by the odometry, are laid over one another as if the way had been longer or shorter. Where the
scene as a whole fits a much longer one, the odometry is wrong.

A person who walks by moves a part of the scene only. The median over all beams that show something decides, the beams
that agree must span a wide angle, and several pairs of scans in a row must agree. A crowd that fills the view and comes
towards the robot passes for an odometry that is wrong, and stops the robot.
"""

import math
from typing import NamedTuple

import numpy as np

from cliffscan.safety.pose2d import Floats, Pose2D

APART = 0.07  # [m] by the odometry between the two scans
LONGEST = 1.5  # [s] between them
TURNED = math.radians(10)  # by which the robot may turn in between
FACTORS = np.array([0.5, 0.75, 1.0, 1.25, 1.5, 1.75, 2.0, 2.5, 3.0, 4.0])  # of the way by the odometry
WRONG = 1.6  # a factor from which on the odometry is wrong; at 80 % of the way it is 1.25
MISFIT = 0.03  # [m] median of the ranges' differences, for the odometry as it is, below which it fits
BETTER = 0.5  # of that misfit: at most so much is left where the longer way fits
FEWEST = 20  # beams that show something in both scans
WIDEST_GAP = math.radians(20)  # the least angle between the outermost beams that fit
IN_A_ROW = 3  # pairs of scans that agree


class Glance(NamedTuple):
    """A scan and where it was taken."""

    ranges: Floats  # (beams,) [m], numbers only count
    angles: Floats  # (beams,) [rad]
    camera: Pose2D
    taken: float  # [s]


class ApproachMonitor:
    """Compares scans as they come, and reports when the robot drives farther than its odometry has it."""

    def __init__(self) -> None:
        self.begin()

    def begin(self) -> None:
        """What was seen before is of another place."""
        self._reference: Glance | None = None
        self._votes = 0

    def see(self, glance: Glance) -> str:
        """Take in a scan; why the odometry is not believed, or nothing."""
        before = self._reference
        if before is None or not self._comparable(before, glance):
            self._reference = glance
            return ""
        if math.hypot(glance.camera.x - before.camera.x, glance.camera.y - before.camera.y) < APART:
            return ""
        factor = way_factor(before, glance)
        self._reference = glance
        if factor is None:
            return ""
        self._votes = self._votes + 1 if factor >= WRONG else 0
        if self._votes < IN_A_ROW:
            return ""
        return f"what the camera sees comes nearer about {factor:.1f} times as fast as the odometry says"

    @staticmethod
    def _comparable(before: Glance, now: Glance) -> bool:
        turned = abs(math.remainder(now.camera.theta - before.camera.theta, math.tau))
        return 0.0 < now.taken - before.taken <= LONGEST and turned <= TURNED and len(before.angles) == len(now.angles)


def way_factor(before: Glance, now: Glance) -> float | None:
    """By which factor the way was longer than the odometry says; None where too little is seen to tell.

    1.0 also where nothing fits clearly better than the odometry does, as between two parallel walls.
    """
    numbers = np.flatnonzero(np.isfinite(before.ranges))
    if numbers.size < FEWEST:
        return None
    ranges, angles = before.ranges[numbers], before.angles[numbers]
    points = before.camera.to_world(ranges * np.stack([np.cos(angles), np.sin(angles)]))
    misfits = np.stack([_misfit(points, before, now, factor) for factor in FACTORS])  # (factors, points)
    compared = np.isfinite(misfits)
    counts = compared.sum(axis=1)
    usable = counts >= max(FEWEST, int(counts.max()) // 2)
    same = int(np.flatnonzero(FACTORS == 1.0)[0])
    if not usable[same]:
        return None
    medians = np.full(len(FACTORS), np.inf)
    medians[usable] = np.nanmedian(misfits[usable], axis=1)
    best = int(medians.argmin())
    if medians[same] < MISFIT or medians[best] > BETTER * medians[same]:
        return 1.0
    fitting = angles[compared[best] & (misfits[best] <= medians[same] * BETTER)]
    return float(FACTORS[best]) if np.ptp(fitting) >= WIDEST_GAP else 1.0


def _misfit(points: Floats, before: Glance, now: Glance, factor: float) -> Floats:
    """By how much [m] the ranges differ if the way was `factor` times as long: (points,), NaN where nothing is seen."""
    x = before.camera.x + factor * (now.camera.x - before.camera.x)
    y = before.camera.y + factor * (now.camera.y - before.camera.y)
    ahead, left = Pose2D(x, y, now.camera.theta).from_world(points)
    increment = now.angles[1] - now.angles[0]
    beams = np.rint((np.arctan2(left, ahead) - now.angles[0]) / increment).astype(np.int64)
    inside = (beams >= 0) & (beams < len(now.angles))
    seen = np.where(inside, now.ranges[np.clip(beams, 0, len(now.angles) - 1)], np.nan)
    seen[~np.isfinite(seen)] = np.nan
    misfit: Floats = np.abs(np.hypot(ahead, left) - seen)
    return misfit
