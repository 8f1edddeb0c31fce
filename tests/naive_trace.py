"""The kernels of services/negative's floor_following, faces, lost_floor, ramps and shadow, slowly and plainly.

Arithmetic is in single precision and in the kernels' order, so that both decide alike.
"""

from itertools import pairwise
from typing import NamedTuple

import numpy as np

from cliffscan.common.contract.camera import Camera, scan_axes
from cliffscan.common.perception.floor_points import METRES
from cliffscan.services.negative import faces as of_faces
from cliffscan.services.negative import floor_following as of_trace
from cliffscan.services.negative import lost_floor as of_lost
from cliffscan.services.negative import ramps as of_ramps
from cliffscan.services.negative import shadow as of_shadow
from cliffscan.services.negative.beam_lines import BeamLines, InView
from cliffscan.services.negative.floor_following import End, FloorCriteria

f32 = np.float32
NEVER = -1


def floor_trace(
    heights: np.ndarray, order: np.ndarray, view: "View", camera_height: f32, criteria: FloorCriteria, line: int
) -> tuple[End, int, f32, int, f32]:
    """What became of the floor along one line: its End, the rows where it was seen last and surely, and its heights."""
    trace = Trace(Sensor(view, order, camera_height, criteria, line))
    with np.errstate(all="ignore"):
        for index, row in enumerate(order):
            height = filled(heights, index, line, trace.sensor.criteria.step)
            rows = f32(abs(int(row) - int(order[index - 1]))) if index else f32(1)
            trace.recent_rows = max(of_trace.RECENT_ROWS, of_trace.RECENT_LOOKS * rows)
            if trace.sensor.begun(int(row)):
                trace.look(int(row), height)
            if trace.end is End.GOING:
                trace.follow_fall(int(row), height, rows)
            if trace.end is not End.GOING:
                break
    return trace.result()


def filled(heights: np.ndarray, index: int, line: int, step: f32) -> f32:
    """A pixel's height; of a speckle the middle of its neighbours', or of theirs, if they agree."""
    here = heights[index, line]
    if not np.isnan(here) or not 2 <= line < heights.shape[1] - 2:
        return here
    for away in (1, 2):
        left, right = heights[index, line - away], heights[index, line + away]
        if abs(left - right) <= step:
            return f32(0.5) * (left + right)
    return f32(np.nan)


class View(NamedTuple):
    """The lines, and the rows in which each has floor in view, as heights_along has them."""

    lines: BeamLines
    in_view: InView


class Sensor:
    """What one line's ray does in a row, and what the sensor makes of it."""

    def __init__(self, view: View, order: np.ndarray, camera_height: f32, criteria: FloorCriteria, line: int) -> None:
        self.lines, self.line = view.lines, line
        self.first, due, self.last = (rows[line] for rows in view.in_view)
        self.height, self.criteria = camera_height, FloorCriteria(*map(f32, criteria))
        self.downward = f32(1) if order[0] > order[-1] else f32(-1)  # the way that rows go toward the robot
        self.per_row = abs(self.lines.fall_step[line]) / camera_height
        nearest = camera_height / max(self.fall(due), self.criteria.grazing)
        spacing = of_trace.SKIPPED_ROWS * nearest * nearest * self.per_row
        self.latest = nearest + max(of_trace.SKIPPED_LENGTH, spacing) if due >= 0 else f32(0)

    def begun(self, row: int) -> bool:
        return (self.first - row) * self.downward >= 0

    def beyond(self, row: int) -> bool:
        """Whether a row is past the last that has the line's floor in view."""
        return (row - self.last) * self.downward < 0

    def fall(self, row: float) -> f32:
        return self.lines.fall[self.line] + f32(row) * self.lines.fall_step[self.line]

    def row(self, row: int) -> tuple[f32, f32, f32]:
        """What a hole shows of its far side at least, and how far floor falls and rises per metre at this row."""
        criteria = self.criteria
        steep = max(self.fall(row), criteria.grazing)
        shortest = of_trace.HOLE_LENGTH
        shown = min(of_trace.HOLE_SHARE * shortest * self.height / (self.height / steep + shortest), criteria.step)
        shown = max(shown, of_trace.UNEVEN)
        slope = min(criteria.slope, steep - criteria.grazing)
        return shown, slope * steep / (steep - slope), criteria.slope * steep / (steep + criteria.slope)


class Trace:
    """The floor along one line, followed outward."""

    def __init__(self, sensor: Sensor) -> None:
        self.sensor = sensor
        self.level = self.incline = f32(0)
        self.rough = sensor.criteria.noise
        self.end, self.row = End.GOING, NEVER
        self.last = NEVER  # row
        self.recent_rows = of_trace.RECENT_ROWS  # ago that floor must have been seen where it leaves the view
        self.below = f32(0)  # rows since floor was seen, those far below counted more
        self.deep = self.above = 0  # rows since floor was seen
        self.doubtful, self.sure, self.sure_level = False, NEVER, f32(0)
        self.brink, self.brink_level = NEVER, f32(0)  # where it was even last
        self.usual = f32(0)  # level of the last while
        self.fallen = False  # away from there

    @property
    def started(self) -> bool:
        return self.last != NEVER

    def rows_since(self) -> f32:
        return f32(self.last - self.row) * self.sensor.downward if self.started else f32(1)

    def look(self, row: int, height: f32) -> None:
        """The next row outward, and what it shows on this line."""
        sensor, criteria = self.sensor, self.sensor.criteria
        self.row, missing = row, np.isnan(height)
        rate = sensor.fall(row)
        depth = (sensor.height - self.level) / rate
        since_rows = self.rows_since()
        since = since_rows * depth * depth * sensor.per_row
        least_angle = rate + min(self.incline, f32(0)) if missing else rate
        seen = rate > 0 and depth <= criteria.far and rate >= criteria.grazing and not sensor.beyond(row)
        if not (seen and least_angle >= criteria.grazing):
            recent = self.started and not self.doubtful and since_rows <= self.recent_rows
            self.end = End.REACHED_RANGE if recent else End.UNVERIFIED
            return
        if depth < criteria.near:
            return
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

    def follow_fall(self, row: int, height: f32, rows: f32) -> None:
        """Whether floor has fallen by a kerb from where it was even, for so long that it is another floor."""
        sensor = self.sensor
        if not self.started or np.isnan(height):
            return
        rate, step = sensor.fall(row), sensor.lines.fall_step[sensor.line]
        depth, lag = (sensor.height - self.level) / rate, self.level - height
        least = of_trace.LAG + of_trace.LAG_SIGMAS * sensor.criteria.noise * depth * sensor.height
        kerb = min(max(of_trace.KERB_SHARE * depth, of_trace.KERB_LEAST), of_trace.KERB_MOST)
        low = min(self.brink_level, self.usual) - height >= kerb
        self.fallen = bool(low if self.fallen else lag > least)
        if self.fallen:
            length = depth - (sensor.height - self.brink_level) / sensor.fall(self.brink)
            if low and length >= of_trace.KERB_LENGTH and abs(self.brink - row) >= of_trace.KERB_ROWS:
                self.end = End.DROP
            return
        if self.last != row:
            return
        share = rows * depth * depth * abs(step) / (sensor.height * of_trace.USUAL_LENGTH)
        share = share if share < 1 and self.brink != NEVER else f32(1)
        self.usual = self.usual + share * (self.level - self.usual)
        if lag < of_trace.STILL * least or self.brink == NEVER:
            self.brink, self.brink_level = row, self.level

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
            doubt = depth > self.sensor.latest or abs(height) > of_trace.STRANGE_HEIGHT or self.below > 0
        self.doubtful = self.doubtful or doubt

    def _taken(self) -> None:
        self.last, self.below, self.deep, self.above = self.row, f32(0), 0, 0
        if not self.doubtful:
            self.sure, self.sure_level = self.row, self.level

    def result(self) -> tuple[End, int, f32, int, f32]:
        if self.end is End.GOING:
            seen = self.started and not self.doubtful and self.rows_since() <= self.recent_rows
            self.end = End.REACHED_RANGE if seen else End.UNVERIFIED
        last, level, sure, sure_level = self.last, self.level, self.sure, self.sure_level
        if self.fallen and (self.brink - last) * self.sensor.downward > 0:
            last, level = self.brink, min(self.brink_level, self.usual)
            self.end = self.end if self.end in (End.DROP, End.NO_RETURN) else End.UNVERIFIED
            if (last - sure) * self.sensor.downward > 0:
                sure, sure_level = last, level
        if last == NEVER and self.end is End.DROP:
            last = int(self.sensor.first)
        return self.end, last, level, sure, sure_level


def seen(
    heights: np.ndarray, order: np.ndarray, view: View, camera_height: float, line: int
) -> list[tuple[int, float, float, float, float]]:
    """Of each row that has a return on a line: the row, its height, its range, its ray's fall and how far it leads."""
    returns = []
    for index, row in enumerate(order):
        if not np.isnan(heights[index, line]):
            height = float(heights[index, line])
            fall = float(view.lines.fall[line]) + float(row) * float(view.lines.fall_step[line])
            ahead = float(view.lines.ahead[line]) + float(row) * float(view.lines.ahead_step[line])
            with np.errstate(divide="ignore", invalid="ignore"):
                reach = float(np.float64(ahead) * (camera_height - height) / fall)
            returns.append((int(row), height, reach, fall, ahead))
    return returns


def outward(order: np.ndarray) -> int:
    """The way that rows go away from the robot."""
    return 1 if order[-1] > order[0] else -1


def foot_of_face(
    heights: np.ndarray,
    order: np.ndarray,
    view: View,
    camera_height: float,
    criteria: FloorCriteria,
    line: int,
    row: int,
) -> tuple[int, float] | None:
    """Row and height of the foot of a face that a line was followed up, to its last floor in `row`."""
    way, over, found = outward(order), [], []
    first = view.in_view.first[line]
    for at, height, reach, fall, ahead in seen(heights, order, view, camera_height, line):
        if (at - first) * way < 0 or (at - row) * way > 0:
            continue
        over.append((height - criteria.slope * reach, at, height))
        depth = reach / ahead
        error = of_faces.SIGMAS * criteria.noise * depth**2 * (fall + criteria.slope * ahead)
        lows = [(max(one[0], other[0]), *other[1:]) for one, other in pairwise(over[:-1])]
        lowest = min(lows, key=lambda low: low[0], default=None)
        found.append(lowest is not None and over[-1][0] - lowest[0] > criteria.step + error)
        if found[-2:] == [True, True]:
            return lowest[1:]
    return None


def reach_in(view: View, line: int, row: float, below: float) -> float:
    """Range of what a line's ray meets in a row, so far below the camera."""
    lines = view.lines
    ahead = float(lines.ahead[line]) + float(row) * float(lines.ahead_step[line])
    return ahead * below / (float(lines.fall[line]) + float(row) * float(lines.fall_step[line]))


def far_off(view: View, camera_height: float, line: int, row: int, level: float) -> bool:
    """Whether a robot on its way to a line's last floor sees it again."""
    due, ground = view.in_view.due[line], camera_height - float(level)
    if row < 0 or due < 0:
        return False
    near = reach_in(view, line, due, ground)
    return reach_in(view, line, row, ground) >= max(of_lost.FAR_OFF, near + of_lost.WAY)


def beyond_lost(
    heights: np.ndarray,
    order: np.ndarray,
    view: View,
    camera_height: float,
    criteria: FloorCriteria,
    line: int,
    row: int,
    level: float,
) -> tuple[bool, bool, bool]:
    """Whether a line shows anything beyond its lost floor, nothing but what is nearer, nothing but floor, soon."""
    ground = camera_height - float(level)
    last = reach_in(view, line, row, ground)
    returns = seen(heights, order, view, camera_height, line)
    beyond = [each for each in returns if (each[0] - row) * outward(order) > 0][: of_lost.RETURNS]
    if len(beyond) < of_lost.RETURNS:
        return False, False, False
    hidden = alike = True
    for _, height, reach, fall, _ in beyond:
        error = criteria.step + of_lost.SIGMAS * criteria.noise * camera_height * ground / fall
        hidden = hidden and height - float(level) > error and reach < last
        alike = alike and abs(height - float(level)) <= error
    length = reach_in(view, line, beyond[0][0], ground) - last
    short = criteria.gap < length <= of_lost.PATCH
    return True, hidden, alike and short and far_off(view, camera_height, line, row, level)


def ramp_ahead(
    heights: np.ndarray, order: np.ndarray, view: View, camera: Camera, criteria: FloorCriteria, line: int, row: int
) -> bool:
    """Whether a ramp that begins at a line's last floor explains all that is seen beyond, and no level floor does."""
    fall, step = (float(values[line]) for values in (view.lines.fall, view.lines.fall_step))
    last = [index for index, at in enumerate(order) if at == row]
    if not last or fall + row * step > criteria.slope + criteria.grazing:
        return False
    falls = fall + np.array(order[last[0] :], float) * step
    inverse = falls / (camera.floor.d - heights[last[0] :, line].astype(float))
    floor, falls, inverse = (falls[0], inverse[0]), falls[1:], inverse[1:]
    seen = ~np.isnan(inverse)
    if seen.sum() < of_ramps.LEAST_ROWS:
        return False
    ramp = np.polynomial.Polynomial.fit(falls[seen], inverse[seen], 1).convert()
    level = (falls[seen] @ inverse[seen]) / (falls[seen] @ falls[seen])
    error = of_ramps.SIGMAS * criteria.noise
    straight = np.abs(ramp(falls) - inverse)[seen].max() <= error
    kerb = np.abs(level * falls - inverse)[seen].max() <= error
    due = (ramp(falls) >= 1.0 / camera.range[1]).sum()
    inclined = 0.0 < ramp.roots()[0] <= criteria.slope
    begins = ramp(floor[0]) >= floor[1] - error
    return bool(straight and not kerb and inclined and begins and seen.sum() >= of_ramps.LEAST_SHARE * due)


def shadowed(camera: Camera, depth: np.ndarray, last: tuple[int, int], beyond: tuple[int, int]) -> bool:
    """Whether something to either side hides from one of the sensor's eyes what lies at a pixel `beyond`."""
    row, column = beyond
    if not (0 <= row < camera.height and 0 <= column < camera.width):
        return False
    return any(_hides(camera, depth, last, beyond, side) for side in (-1, 1))


def _hides(camera: Camera, depth: np.ndarray, last: tuple[int, int], beyond: tuple[int, int], side: int) -> bool:
    """Whether the first thing that is seen on that side stands, near enough, with hardly anything in between."""
    row, column = beyond
    _, _, up = (axis.table() for axis in scan_axes(camera))
    disparity = camera.baseline * camera.intrinsics.fx
    for away in range(1, camera.width):
        beside = column + side * away
        if not 0 <= beside < camera.width:
            return False
        metres = usable(camera, depth, row, beside)
        if metres is None:
            continue
        if metres * up[row, beside] + camera.floor.d < of_shadow.STANDING:
            return False
        floor = -up[row, column] / camera.floor.d
        if away > disparity * (1.0 / metres - floor) + of_shadow.SLACK:
            return False
        between = [usable(camera, depth, last[0], last[1] + side * k) for k in range(of_shadow.BESIDE + 1, away)]
        returns = sum(each is not None for each in between)
        return returns <= of_shadow.SEEN * max(away - of_shadow.BESIDE, 0)
    return False


def usable(camera: Camera, depth: np.ndarray, row: int, column: int) -> float | None:
    """A pixel's depth [m] if it is a measurement."""
    if not 0 <= column < camera.width:
        return None
    millimetres = int(depth[row, column])
    return float(METRES * millimetres) if camera.range[0] * 1000 <= millimetres <= camera.range[1] * 1000 else None
