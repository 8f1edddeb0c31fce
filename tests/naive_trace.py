"""The kernels of services/negative/floor_following.py and shadow.py, slowly and plainly: column by column, row by row.

Arithmetic is in single precision and in the kernels' order, so that both decide alike.
"""

import numpy as np

from cliffscan.common.contract.camera import Affine
from cliffscan.services.negative import floor_following as of_trace
from cliffscan.services.negative import shadow as of_shadow
from cliffscan.services.negative.floor_following import End, FloorCriteria

f32 = np.float32
NEVER = -1


def floor_trace(
    heights: np.ndarray, order: np.ndarray, rates: Affine, camera_height: f32, criteria: FloorCriteria, column: int
) -> tuple[End, int, f32, int, f32]:
    """What became of the floor in one column: its End, the rows where it was seen last and surely, and its heights."""
    sensor = Sensor(rates, camera_height, criteria, order[0])
    trace = Trace(sensor, column)
    with np.errstate(all="ignore"):
        for row in order:
            trace.look(int(row), filled(heights, int(row), column, sensor.criteria.step))
            if trace.end is not End.GOING:
                break
    return trace.result()


def filled(heights: np.ndarray, row: int, column: int, step: f32) -> f32:
    """A pixel's height; of a speckle the middle of its neighbours', or of theirs, if they agree."""
    here = heights[row, column]
    if not np.isnan(here) or not 2 <= column < heights.shape[1] - 2:
        return here
    for away in (1, 2):
        left, right = heights[row, column - away], heights[row, column + away]
        if abs(left - right) <= step:
            return f32(0.5) * (left + right)
    return f32(np.nan)


class Sensor:
    """What all columns have in common."""

    def __init__(self, rates: Affine, camera_height: f32, criteria: FloorCriteria, first_row: int) -> None:
        self.rates, self.height, self.criteria = rates, camera_height, FloorCriteria(*map(f32, criteria))
        self.downward = f32(1) if rates.rows[0] < rates.rows[1] else f32(-1)  # the way that rows go toward the robot
        self.per_row = abs(rates.rows[1] - rates.rows[0]) / camera_height
        self.middle = rates.columns[len(rates.columns) // 2]
        lowest = max(self.middle + rates.rows[first_row], self.criteria.grazing)
        self.nearest = max(self.criteria.near, camera_height / lowest) + of_trace.LATE_DEPTH

    def row(self, row: int) -> tuple[f32, f32, f32]:
        """What a hole shows of its far side at least, and how far floor falls and rises per metre along this row."""
        criteria = self.criteria
        steep = max(self.middle + self.rates.rows[row], criteria.grazing)
        shortest = of_trace.HOLE_LENGTH
        shown = min(of_trace.HOLE_SHARE * shortest * self.height / (self.height / steep + shortest), criteria.step)
        shown = max(shown, of_trace.UNEVEN)
        slope = min(criteria.slope, steep - criteria.grazing)
        return shown, slope * steep / (steep - slope), criteria.slope * steep / (steep + criteria.slope)


class Trace:
    """The floor in one column, followed outward."""

    def __init__(self, sensor: Sensor, column: int) -> None:
        self.sensor, self.column = sensor, column
        self.level = self.incline = f32(0)
        self.rough = sensor.criteria.noise
        self.end, self.row = End.GOING, NEVER
        self.last = self.first_look = NEVER  # rows
        self.below = f32(0)  # rows since floor was seen, those far below counted more
        self.deep = self.above = 0  # rows since floor was seen
        self.doubtful, self.sure, self.sure_level = False, NEVER, f32(0)

    @property
    def started(self) -> bool:
        return self.last != NEVER

    def rows_since(self) -> f32:
        return f32(self.last - self.row) * self.sensor.downward if self.started else f32(1)

    def look(self, row: int, height: f32) -> None:
        """The next row outward, and what it shows at this column."""
        sensor, criteria = self.sensor, self.sensor.criteria
        self.row, missing = row, np.isnan(height)
        rate = sensor.rates.columns[self.column] + sensor.rates.rows[row]
        depth = (sensor.height - self.level) / rate
        since = self.rows_since() * depth * depth * sensor.per_row
        since_rows = self.rows_since()
        least_angle = rate + min(self.incline, f32(0)) if missing else rate
        if not (rate > 0 and depth <= criteria.far and rate >= criteria.grazing and least_angle >= criteria.grazing):
            seen = self.started and not self.doubtful and since_rows <= of_trace.RECENT_ROWS
            self.end = End.REACHED_RANGE if seen else End.UNVERIFIED
            return
        if depth < criteria.near:
            return
        if self.first_look == NEVER:
            self.first_look = row
        gap = self.started and since_rows > of_trace.NO_RETURN_ROWS and since > criteria.gap
        gap = gap and self.rough < of_trace.NO_RETURN_ROUGHNESS * criteria.noise
        if missing:
            self.end = End.NO_RETURN if gap else End.GOING
            return

        shown, falls, rises = sensor.row(row)
        may_fall, may_rise, deviation = falls * since, rises * since, depth * sensor.height
        sigma = (self.rough if self.rough > of_trace.ROUGH_FROM * criteria.noise else criteria.noise) * deviation
        slack = may_fall + (f32(0) if self.started else of_trace.UNSEEN_SLOPE * depth)
        small = slack + max(of_trace.BELOW_SIGMAS * sigma, shown)
        large = slack + criteria.step + of_trace.DEEP_SIGMAS * sigma
        high = may_rise + criteria.step + of_trace.ABOVE_SIGMAS * criteria.noise * deviation
        fall = self.level - height
        if fall > small:
            self._below(fall > large, fall > of_trace.STRONG_FALL * small, fall, height, depth, since)
        elif -fall > high:
            self.above += 1
            if self.above >= of_trace.OBSTACLE_ROWS:
                self.end = End.NO_RETURN if gap else End.OCCLUDED
        elif self.below > of_trace.BESIDE_ROWS and self.started:
            self.end = End.DROP  # floor on the far side of something that lies below it
        else:
            self._floor(height, fall, rate, depth, since, may_fall, may_rise)

    def _below(self, deep: bool, strong: bool, fall: f32, height: f32, depth: f32, since: f32) -> None:
        """Something lower than floor can be: a drop, or after some rows of it, none of them deep, a step down."""
        self.below += of_trace.STRONG_ROWS if strong else f32(1)
        self.deep += deep
        settled = self.below >= of_trace.STEP_ROWS and not self.deep
        if self.deep >= of_trace.DEEP_ROWS or (settled and fall > self.sensor.criteria.step):
            self.end = End.DROP
        elif settled:
            self._doubt(height, depth, since)
            self.level = height
            self._taken()

    def _floor(self, height: f32, fall: f32, rate: f32, depth: f32, since: f32, may_fall: f32, may_rise: f32) -> None:
        """Floor: its level follows slowly; what it deviates tells how rough it is, how it changes how it inclines."""
        self._doubt(height, depth, since)
        noise, per_deviation = self.sensor.criteria.noise, f32(1) / (self.sensor.height * self.sensor.height)
        change = min(max(-of_trace.LEVEL_GAIN * fall, -may_fall), may_rise) if self.started else -fall
        if self.started:
            self.incline = self.incline + (change - self.incline * since) / of_trace.INCLINE_LENGTH
        seen_rough = of_trace.SIGMA_OF_DEVIATION * abs(fall) * rate * per_deviation
        rough = self.rough + of_trace.ROUGHNESS_GAIN * (seen_rough - self.rough)
        self.rough = min(max(rough, noise), of_trace.ROUGH_MOST * noise)
        self.level = self.level + change
        self._taken()

    def _doubt(self, height: f32, depth: f32, since: f32) -> None:
        """Floor first seen far off, or not at the plane's height, may be another floor; that beyond a gap as well."""
        if self.started:
            doubt = self.rows_since() > of_trace.SKIPPED_ROWS and since > of_trace.SKIPPED_LENGTH
        else:
            doubt = depth > self.sensor.nearest or abs(height) > of_trace.STRANGE_HEIGHT or self.below > 0
        self.doubtful = self.doubtful or doubt

    def _taken(self) -> None:
        self.last, self.below, self.deep, self.above = self.row, f32(0), 0, 0
        if not self.doubtful:
            self.sure, self.sure_level = self.row, self.level

    def result(self) -> tuple[End, int, f32, int, f32]:
        if self.end is End.GOING:
            seen = self.started and not self.doubtful and self.rows_since() <= of_trace.RECENT_ROWS
            self.end = End.REACHED_RANGE if seen else End.UNVERIFIED
        if not self.started and self.end is End.DROP:
            return self.end, self.first_look, self.level, self.sure, self.sure_level
        return self.end, self.last, self.level, self.sure, self.sure_level


def shadowed(
    heights: np.ndarray, rates: Affine, camera_height: f32, column: int, last: int, outward: int, disparity: float
) -> bool:
    """Whether something to either side hides from one of the sensor's eyes what lies beyond row `last`."""
    row = last + 2 * outward
    if not 0 <= row < len(heights):
        return False
    return any(_hides(heights, rates, camera_height, column, last, row, side, disparity) for side in (-1, 1))


def _hides(heights, rates, camera_height, column: int, last: int, row: int, side: int, disparity: float) -> bool:
    """Whether the first thing that is seen on that side stands, near enough, with hardly anything in between."""
    for away in range(1, heights.shape[1]):
        beside = column + side * away
        if not 0 <= beside < heights.shape[1]:
            return False
        if np.isnan(heights[row, beside]):
            continue
        if float(heights[row, beside]) < of_shadow.STANDING:
            return False
        depth = float((camera_height - heights[row, beside]) / (rates.columns[beside] + rates.rows[row]))
        floor = float((rates.columns[column] + rates.rows[row]) / camera_height)
        if away > disparity * (np.divide(1.0, depth) - floor) + of_shadow.SLACK:
            return False
        between = [heights[last, column + side * k] for k in range(of_shadow.BESIDE + 1, away)]
        returns = sum(not np.isnan(each) for each in between)
        return returns <= of_shadow.SEEN * max(away - of_shadow.BESIDE, 0)
    return False
