"""Low steps: where the floor rises or falls by more than a wheel takes, though less than makes an obstacle or a drop.

A ramp, a wave of the floor and a floor plane that is wrong are smooth along a line. A step is not: between two points
next to each other the height changes by more than `step`, and stays so. The slow twin is tests/naive_low_steps.py.

   height                        x x x x   stays: ROWS and LENGTH
     |                         x            \
     |                         x             at least a step, and more than noise and roughness do
     |  x  x  x  x x x x x x x              /
     |_________________________________ distance
        run of floor         |-|  sharp
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from cliffscan.common.contract.camera import Floats
from cliffscan.common.perception.floor_points import Metres
from cliffscan.common.perception.image_region import ImageRegion

f32 = np.float32
SHARP_RISE, SHARP_FALL = f32(0.03), f32(0.05)  # [m] within which the height changes; a fall may lie in shadow
ROWS, LENGTH = f32(3.0), f32(0.05)  # points, and [m] of them, that show it to stay
RUN, RUN_BEFORE_FALL = f32(0.02), f32(0.15)  # [m] of floor before; more before a fall: a sill's top is no floor
DEVIATIONS = 5.0  # of a height, up to which it is noise
ROUGH, ROUGH_LENGTH = f32(6.0), f32(0.1)  # times the floor's mean deviation from its level, over so much of it [m]
STRANGE = f32(0.045)  # [m] above or below the plane; what is first seen there is no floor
HIGH = f32(0.1)  # [m]; what rises by more is no low step, and may hang above the robot
STILL, LASTING = f32(0.5), f32(0.8)  # of the least step, up to which a height is floor, and from which a step stays
GAIN = f32(0.5)  # of a new height in the floor's level
FARTHEST = 1.75  # [m]; beyond, the waves of real sensors look like steps
NEXT = 3  # rows, within which a step shows
ENOUGH = 320  # lines; of an image with more some are looked at: at 1 m they lie 3 mm apart
APART = 0.015  # [m] of floor between two rows that are looked at, where the image has more
BEYOND = 1.15  # times as far a row would see floor that shows the top of a step up
ABREAST, AGREEING, AGREE = 3, 5, 0.06  # lines to either side, how many of them all agree, and to how much [m]
NONE, RISE, FALL, SURE = f32(0.0), f32(1.0), f32(-1.0), f32(2.0)
WHOLE, BROKEN, MENDED = f32(0.0), f32(1.0), f32(2.0)  # the floor since it came into view
ZERO, ONE, NOWHERE = f32(0.0), f32(1.0), f32(-1.0)


RowNumbers = NDArray[np.int64]


class Sight(NamedTuple):
    """What a camera can tell of low steps, in single precision."""

    camera_height: np.float32  # [m]
    step: np.float32  # [m] of height, up to which a wheel takes it
    uncertain: np.float32  # [m] that noise may do to a height, for each metre from the camera
    slope: np.float32  # rise per metre of the steepest floor
    reach: np.float32  # [m] up to which rows lie close enough to tell a step from a slope

    @classmethod
    def of(cls, region: ImageRegion, step: float, slope: float) -> Sight:
        """Of what is looked at of an image, for steps above `step` [m] on floor of at most `slope`."""
        camera = region.camera
        height, focal = camera.floor.d, camera.intrinsics.fx if region.transposed else camera.intrinsics.fy
        close = math.sqrt(max(float(SHARP_RISE) * focal * height - height * height, 0.0))
        return cls(*map(f32, (height, step, DEVIATIONS * camera.noise * height, slope, min(close, FARTHEST))))


class Steps(NamedTuple):
    """The first step along each line; float32, (lines,) each."""

    kind: Metres  # RISE, FALL or NONE
    row: Metres  # in which it shows first,
    before: Metres  # and in which the floor before it was seen last,
    level: Metres  # [m] at that height
    distance: Metres  # [m] where it shows first


def low_steps(heights: Metres, distances: Metres, rows: RowNumbers, sight: Sight) -> Steps:
    """The first step along each line, as most lines beside it have it.

    heights above the floor plane and distances along it [m]: (rows, lines), NaN height = no return; rows: the numbers
    of those that are looked at, from the robot outward, as rows_near has them.
    """
    every = max(1, heights.shape[1] // ENOUGH)
    some = every * np.flatnonzero(uneven(heights[:, ::every], rows, sight))
    return agree(follow(heights, distances, rows, some, sight), every)


@njit(cache=True, error_model="numpy")
def rows_near(falls: Floats, outward: int, sight: Sight) -> RowNumbers:
    """The numbers of the rows that see what is within reach, from the robot outward, each APART beyond the one before.

    falls: what the rays of each row lose in height per metre along the floor, (rows,); outward: 1 where rows lead away
    from the robot, or -1.
    """
    chosen, many, last = np.empty(len(falls), np.int64), 0, -1.0
    for index in range(len(falls)):
        row = index if outward > 0 else len(falls) - 1 - index
        place = np.floor(sight.camera_height / (falls[row] * APART)) if falls[row] > 0.0 else np.inf
        if place * APART <= BEYOND * sight.reach and place != last:
            chosen[many] = row
            many, last = many + 1, place
    return chosen[:many]


@njit(cache=True, error_model="numpy")
def uneven(heights: Metres, rows: RowNumbers, sight: Sight) -> NDArray[np.bool_]:
    """Which lines change their height within NEXT rows by enough for a step at all: (lines,)."""
    lines = heights.shape[1]
    most = np.full(lines, ZERO)
    for index in range(NEXT, len(rows)):
        row, before = rows[index], rows[index - NEXT]
        for u in range(lines):
            change = abs(heights[row, u] - heights[before, u])
            most[u] = change if change > most[u] else most[u] + ZERO
    return most > STILL * sight.step


@njit(cache=True, error_model="numpy")
def follow(heights: Metres, distances: Metres, rows: RowNumbers, some: RowNumbers, sight: Sight) -> Steps:
    """The first step along some lines, none along the others."""
    lines = len(some)
    kind, level, distance = np.full(lines, NONE), np.full(lines, ZERO), np.full(lines, ZERO)
    first_row, before, count = np.full(lines, NOWHERE), np.full(lines, NOWHERE), np.full(lines, ZERO)
    far, last, run_from = np.full(lines, NOWHERE), np.full(lines, ZERO), np.full(lines, ZERO)
    rough, floor = np.full(lines, ZERO), np.full(lines, WHOLE)
    seen_heights, seen_distances = np.empty(lines, np.float32), np.empty(lines, np.float32)
    for index in range(len(rows)):
        row = rows[index]
        at = f32(row)
        for u in range(lines):  # two loops, for the processor's vectors: only one picks lines
            seen_heights[u], seen_distances[u] = heights[row, some[u]], distances[row, some[u]]
        for u in range(lines):
            height, away = seen_heights[u], seen_distances[u]
            was, here, last_far, last_away = kind[u], level[u], far[u], last[u]
            was_floor, was_run, was_rough = floor[u], run_from[u], rough[u]
            was_row, was_before, was_count, was_start = first_row[u], before[u], count[u], distance[u]
            started = last_far >= ZERO
            begun = started | ((height <= STRANGE) & (height >= -STRANGE))
            seen = (height == height) & (away <= sight.reach) & (was < SURE) & (was > -SURE) & begun

            # by how much the height changes, and how much that must be
            changed = height - here if started else ZERO
            amount = changed if changed > ZERO else -changed
            noise = sight.uncertain * np.sqrt(away * away + sight.camera_height * sight.camera_height)
            least = noise if noise > sight.step else sight.step
            least = least if least > ROUGH * was_rough else ROUGH * was_rough
            falls = changed < ZERO
            steps = seen & (amount > least) & (falls | (changed <= HIGH))
            still = seen & (amount <= STILL * least)

            # whether it does so at once, on floor, and then stays
            grazed = away * (sight.camera_height - here) / (sight.camera_height - height)
            met = grazed if falls else away  # a lower floor is hidden up to where the ray over the edge comes down
            gap, run = met - last_far, last_far - was_run
            sharp = gap <= (SHARP_FALL if falls else SHARP_RISE)
            known = (run >= RUN) & ((run >= RUN_BEFORE_FALL) | (was_floor == WHOLE) | (not falls))
            lasts = seen & (changed * was > LASTING * least) & (changed <= HIGH)
            begins = steps & (not lasts) & started & sharp & known
            counted = was_count + ONE
            stays = lasts & (counted >= ROWS) & (away - was_start >= LENGTH)
            begun_kind = FALL if falls else RISE
            new = begun_kind if begins else NONE
            now = was if lasts | (not seen) else new
            follows = seen & (now == NONE)

            # the floor as it goes on
            further = away - last_away
            further = further if started & (further > ZERO) else ZERO
            may = sight.slope * further
            change = GAIN * changed
            change = change if change > -may else -may
            change = change if change < may else may
            change = change if started else height
            share = further / ROUGH_LENGTH
            share = share if share < ONE else ONE
            resumes = still & (was_floor == BROKEN)
            breaks = follows & (not still)
            new_floor = BROKEN if breaks else was_floor
            on_a_thing = seen & (not started) & ((height > sight.step) | (height < -sight.step))

            kind[u] = SURE * now if stays else now
            level[u] = here + (change if follows else ZERO)
            rough[u] = was_rough + (share * (amount - was_rough) if follows & still else ZERO)
            count[u] = ONE if begins else (counted if lasts else was_count)
            distance[u] = away if begins else was_start
            first_row[u] = at if begins else was_row
            before[u] = at if still else was_before
            far[u] = away if still else last_far
            last[u] = away if seen else last_away
            run_from[u] = away if resumes | (still & (not started)) else was_run
            floor[u] = MENDED if resumes | on_a_thing else new_floor
    many = heights.shape[1]
    found = Steps(
        np.full(many, NONE), np.full(many, NOWHERE), np.full(many, NOWHERE), np.full(many, ZERO), np.full(many, ZERO)
    )
    for u in range(lines):
        line = some[u]
        found.kind[line] = kind[u] / SURE if abs(kind[u]) == SURE else NONE
        found.row[line], found.before[line] = first_row[u], before[u]
        found.level[line], found.distance[line] = level[u], distance[u]
    return found


@njit(cache=True)
def agree(steps: Steps, every: int) -> Steps:
    """The steps as most lines beside have them: what few see is noise, what few miss is speckle.

    every: of so many lines one was looked at, the first; the others get what it has.
    """
    lines, around = len(steps.kind), every * ABREAST
    kind, row, before = np.full(lines, NONE), steps.row.copy(), steps.before.copy()
    level, distance = steps.level.copy(), steps.distance.copy()
    for u in range(0, lines, every):
        like = u
        for away in range(every, around + 1, every):  # the nearest that has a step
            if steps.kind[like] == NONE and u - away >= 0:
                like = u - away
            if steps.kind[like] == NONE and u + away < lines:
                like = u + away
        if steps.kind[like] == NONE:
            continue
        alike = 0
        for other in range(max(u - around, 0), min(u + around + 1, lines), every):
            near = abs(steps.distance[other] - steps.distance[like]) <= AGREE
            alike += near & (steps.kind[other] == steps.kind[like])
        for line in range(u, min(u + every, lines)):
            kind[line] = steps.kind[like] if alike >= AGREEING else NONE
            row[line], before[line] = steps.row[like], steps.before[like]
            level[line], distance[line] = steps.level[like], steps.distance[like]
    return Steps(kind, row, before, level, distance)
