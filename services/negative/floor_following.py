r"""Following the floor outward along all lines of the image at once; its slow twin is tests/naive_trace.py.

A line's rows are looked at from near to far. `level` is how high the floor was where it was seen last. What a row
shows is floor, or lies below or above what floor can be there, or is missing. A line is GOING until one row ends it:

   camera
     o
    /|\ ` .                     ________ . . . .   floor, up to the sensor's range     REACHED_RANGE
   / | \   ` .                                     ... or it was not seen throughout   UNVERIFIED
  /  |  \     ` .               ________
 /   |   \       ` .                    |_______   DEEP_ROWS below by over a step,
/    |    \         ` .                            or STEP_ROWS below, or floor beyond  DROP
_____|_____\__________` .              ________
                                       |           OBSTACLE_ROWS above                 OCCLUDED
     row by row ---->           _______|
                                ________  ? ? ?    no return over criteria.gap         NO_RETURN

Floor that begins late or at a strange height, or goes on beyond a gap, may be another floor: the line is followed on,
but its floor is sure up to sure_row alone.
"""

from __future__ import annotations

from enum import IntEnum
from typing import Generic, NamedTuple, TypeVar

import numpy as np
from numba import njit

from cliffscan.common.perception.floor_points import Metres
from cliffscan.services.negative.beam_lines import NOWHERE, BeamLines, InView, Rows

N = TypeVar("N", float, np.float32)
f32 = np.float32


class End(IntEnum):
    """Why a line's floor was followed no farther."""

    GOING = -1  # it still is
    REACHED_RANGE = 0  # the floor goes on to where the sensor sees none
    DROP = 1  # a surface below the floor was seen
    NO_RETURN = 2  # no data where the floor must be visible
    OCCLUDED = 3  # something stands in the way
    UNVERIFIED = 4  # the floor was not seen throughout


class FloorCriteria(NamedTuple, Generic[N]):
    """What the sensor can do, and what a floor is, as configured; the gates below are fixed."""

    near: N  # [m] of depth, from which
    far: N  # [m] and up to which the sensor measures floor
    noise: N  # [1/m] standard deviation of the inverse depth, steps included
    grazing: N  # sine of the angle to a surface below which it may return nothing
    slope: N  # rise or fall per metre of the steepest floor
    step: N  # [m] of rise or fall beyond which a surface is no floor
    gap: N  # [m] of floor without a return that is more than chance


def single(criteria: FloorCriteria[float]) -> FloorCriteria[np.float32]:
    """The same in single precision, as floor_trace takes it."""
    return FloorCriteria(*map(np.float32, criteria))


# One gate a test, in this file for numba's sake: it compiles them in, and compiles anew when this file changes.
# Below the floor: a drop, or a step down that may be driven
BELOW_SIGMAS = f32(6.0)  # a height that is lower by more sigmas of noise is below,
HOLE_LENGTH = f32(0.1)  # [m] or by what a hole so long along the beam shows of its far side,
HOLE_SHARE = f32(0.6)  # this share of what geometry has it,
UNEVEN = f32(0.012)  # [m] and no less than a flat floor rises and falls from row to row, and sensors err
DEEP_SIGMAS = f32(4.0)  # far below, if by a step and more sigmas than that
DEEP_ROWS = f32(2.0)  # rows far below that make a drop
STEP_ROWS = f32(5.0)  # rows below that tell a drop from a step down
STRONG_FALL, STRONG_ROWS = f32(1.25), f32(1.1)  # times the least fall, from which a row counts for that many
BESIDE_ROWS = f32(1.0)  # more rows below than that, and then floor again, are a hole
# Fallen away
LAG, LAG_SIGMAS = f32(0.012), f32(3.0)  # [m] and sigmas of noise below its level, from which floor falls away
STILL = f32(0.5)  # of that, up to which it does not yet
KERB_LEAST, KERB_MOST = f32(0.03), f32(0.05)  # [m] below the brink; less is uneven floor,
KERB_SHARE = f32(0.015)  # of the depth between them: far off, stereo bows a floor by as much
KERB_LENGTH, KERB_ROWS = f32(0.5), f32(5.0)  # [m] of depth and rows, over which it stays so low
LEAST_LENGTH = f32(0.001)  # [m] of floor that falls, but not yet so low
USUAL_LENGTH = f32(0.3)  # [m] of floor whose level counts, where a bump at the brink is higher
# Above the floor: an obstacle
ABOVE_SIGMAS = f32(4.0)  # a height that is higher by a step and more sigmas of noise is above
OBSTACLE_ROWS = f32(2.0)  # rows above that make an obstacle
# No return
NO_RETURN_ROWS = f32(4.0)  # rows without floor that are chance
NO_RETURN_ROUGHNESS = f32(4.0)  # noises; a floor rougher than that may return nothing
# Unverified, and doubtful
RECENT_ROWS, RECENT_LOOKS = f32(4.0), f32(2.0)  # rows ago, or rows that were looked at, that floor must have been seen
# where it leaves the image or the sensor's range
SKIPPED_ROWS, SKIPPED_LENGTH = f32(4.0), f32(0.05)  # rows and [m] without floor beyond which, or beyond the nearest
# that a line can show, it may be another
STRANGE_HEIGHT = f32(0.045)  # [m] above or below the plane; first seen there, it may be another
# The floor as it goes on
LEVEL_GAIN = f32(0.5)  # of a new height in the floor's level
INCLINE_LENGTH = f32(0.3)  # [m] of floor over which its incline is known
ROUGHNESS_GAIN = f32(0.2)  # of a new deviation in the floor's roughness
SIGMA_OF_DEVIATION = f32(1.25)  # standard deviations in a mean deviation
ROUGH_FROM, ROUGH_MOST = f32(2.5), f32(6.0)  # noises from which roughness counts in noise's place, and its most
UNSEEN_SLOPE = f32(0.0875)  # that the floor may have before the camera sees it

# All state is float32, rows and counts as well: lanes of one width are what the processor's vectors are made of.
ZERO, ONE, HALF, NAN = f32(0.0), f32(1.0), f32(0.5), f32(np.nan)
GOING, REACHED_RANGE, DROP, NO_RETURN, OCCLUDED, UNVERIFIED = (f32(end) for end in End)


@njit(cache=True, error_model="numpy")
def fill_speckle(heights: Metres, row: int, step: np.float32, filled: Metres) -> None:
    """A row's heights; where one is missing, the middle of its neighbours' if they agree. Speckle is no gap."""
    for u in range(len(filled)):
        filled[u] = heights[row, u]
    for u in range(len(filled) - 4):
        left, right = heights[row, u + 1], heights[row, u + 3]
        beside = HALF * (left + right) if abs(left - right) <= step else NAN
        left, right = heights[row, u], heights[row, u + 4]
        wider = HALF * (left + right) if abs(left - right) <= step else NAN
        here = heights[row, u + 2]
        beside = beside if beside == beside else wider
        filled[u + 2] = here if here == here else beside


@njit(cache=True, error_model="numpy")
def allowances(
    fall: np.float32, camera_height: np.float32, criteria: FloorCriteria[np.float32]
) -> tuple[np.float32, np.float32, np.float32]:
    """What a hole shows of its far side at least [m], and how far floor falls and rises per metre of depth.

    fall: what the ray there loses in height per metre of depth.
    """
    steep = max(fall, criteria.grazing)
    shown = min(HOLE_SHARE * HOLE_LENGTH * camera_height / (camera_height / steep + HOLE_LENGTH), criteria.step)
    fallable = min(criteria.slope, steep - criteria.grazing)
    falls = fallable * steep / (steep - fallable)
    return max(shown, UNEVEN), falls, criteria.slope * steep / (steep + criteria.slope)


@njit(cache=True, error_model="numpy")
def latest_depth(fall: np.float32, camera_height: np.float32, spread: np.float32, grazing: np.float32) -> np.float32:
    """Depth [m] by which a line must show floor, lest it be another: of its own nearest, and a little.

    fall: as in `allowances`, in the row in which it is due; spread [1/m]: metres of depth from row to row, per square
    metre of it.
    """
    nearest = camera_height / max(fall, grazing)
    return nearest + max(SKIPPED_LENGTH, SKIPPED_ROWS * nearest * nearest * spread)


@njit(cache=True, error_model="numpy")
def follow_fall(
    at: np.float32,
    rows: np.float32,
    heights: Metres,
    lines: BeamLines,
    camera_height: np.float32,
    noise: np.float32,
    going: Metres,
    floor_row: Metres,
    level: Metres,
    brink_row: Metres,
    brink_level: Metres,
    usual: Metres,
    fallen: Metres,
) -> None:
    """Keep, row by row, where the floor of each line was even, and how far [m] it has fallen away since.

    at: the row, `rows` beyond the one before; heights [m] in it; going: negative, of lines that are still followed;
    floor_row, level [m]: where floor was seen last, this row included. Changed in place: the brink's row and level,
    the usual level [m], and the depth [m] over which floor has fallen, 0 = it has not; (lines,) each.
    """
    for u in range(len(heights)):
        height, here, brink, brink_height = heights[u], level[u], brink_row[u], brink_level[u]
        last_usual, fallen_before, was_fallen = usual[u], fallen[u], fallen[u] > ZERO
        step = lines.fall_step[u]
        fall = lines.fall[u] + at * step
        depth = (camera_height - here) / fall
        lag, least = here - height, LAG + LAG_SIGMAS * noise * depth * camera_height
        seen = (going[u] < ZERO) & (floor_row[u] >= ZERO) & (height == height)
        kerb = KERB_SHARE * depth if KERB_SHARE * depth > KERB_LEAST else KERB_LEAST
        kerb = kerb if kerb < KERB_MOST else KERB_MOST
        low = (brink_height if brink_height < last_usual else last_usual) - height >= kerb
        is_fallen = (low if was_fallen else lag > least) if seen else was_fallen
        since = depth - (camera_height - brink_height) / (lines.fall[u] + brink * step)
        floor = seen & (floor_row[u] == at) & (not is_fallen)
        even = floor & ((lag < STILL * least) | (brink < ZERO))
        share = rows * depth * depth * abs(step) / (camera_height * USUAL_LENGTH)
        share = share if (share < ONE) & (brink >= ZERO) else ONE
        brink_row[u] = at if even else brink
        brink_level[u] = here if even else brink_height
        usual[u] = last_usual + share * (here - last_usual) if floor else last_usual
        length = since if low & (abs(brink - at) >= KERB_ROWS) else LEAST_LENGTH
        fallen[u] = (length if seen else fallen_before) if is_fallen else ZERO


@njit(cache=True, error_model="numpy")
def floor_trace(
    heights: Metres,
    order: Rows,
    lines: BeamLines,
    in_view: InView,
    camera_height: np.float32,
    criteria: FloorCriteria[np.float32],
) -> tuple[Metres, Metres, Metres, Metres, Metres]:
    """What became of the floor along each line: its End, and two rows with the floor's height [m] there; all (lines,).

    The first row is where floor was last seen or, of a drop before any floor, the first that was looked at; the second
    is up to where floor was seen without a gap or a doubt; -1 = nowhere.
    heights, order, lines, in_view: as heights_along has them; camera_height [m]; criteria: in single precision.
    """
    near, far, noise, grazing, step = criteria.near, criteria.far, criteria.noise, criteria.grazing, criteria.step
    many = heights.shape[1]
    filled = np.empty(many, np.float32)
    # the state of each line
    end = np.full(many, GOING)
    floor_row, sure_row = np.full(many, NOWHERE), np.full(many, NOWHERE)  # they differ once floor is doubtful
    level, sure_level = np.zeros(many, np.float32), np.zeros(many, np.float32)  # [m] of the floor at these rows
    incline = np.zeros(many, np.float32)  # rise per metre
    roughness = np.full(many, noise)  # [1/m] of inverse depth, as noise
    rows_below, rows_deep = np.zeros(many, np.float32), np.zeros(many, np.float32)  # since floor was seen
    rows_above = np.zeros(many, np.float32)
    brink_row, brink_level = np.full(many, NOWHERE), np.zeros(many, np.float32)  # as follow_fall has them
    usual, fallen = np.zeros(many, np.float32), np.zeros(many, np.float32)
    outward = ONE if order[0] > order[-1] else -ONE  # how many rows nearer is the row of the next higher number
    spread, latest = np.empty(many, np.float32), np.empty(many, np.float32)
    fall_at_0, fall_step = lines.fall.copy(), lines.fall_step.copy()
    first, last = in_view.first.copy(), in_view.last.copy()
    for u in range(many):
        spread[u] = abs(lines.fall_step[u]) / camera_height
        due = in_view.due[u]
        nearest = latest_depth(fall_at_0[u] + due * fall_step[u], camera_height, spread[u], grazing)
        latest[u] = nearest if due >= ZERO else ZERO
    per_deviation = ONE / (camera_height * camera_height)
    at, recent_rows = ZERO, RECENT_ROWS
    for index in range(len(order)):
        at = np.float32(order[index])
        rows = abs(at - np.float32(order[index - 1])) if index else ONE
        recent_rows = max(RECENT_ROWS, RECENT_LOOKS * rows)
        fill_speckle(heights, index, step, filled)
        for u in range(many):
            height, ended, last_row, last_sure = filled[u], end[u], floor_row[u], sure_row[u]
            last_level, last_incline, last_rough = level[u], incline[u], roughness[u]
            below, deep, above = rows_below[u], rows_deep[u], rows_above[u]
            begun = (first[u] - at) * outward >= ZERO
            active, started, missing = (ended < ZERO) & begun, last_row >= ZERO, height != height
            doubtful = last_sure != last_row

            # where the floor would be seen, and how far that is from where it last was
            rate = fall_at_0[u] + at * fall_step[u]
            shown, falls, rises = allowances(rate, camera_height, criteria)
            depth = (camera_height - last_level) / rate
            rows_since = (last_row - at) * outward if started else ONE
            since = rows_since * depth * depth * spread[u]
            falling = last_incline if last_incline < ZERO else ZERO
            in_range = (rate > ZERO) & (depth <= far) & (rate >= grazing) & ((at - last[u]) * outward >= ZERO)
            in_range = in_range & ((not missing) | (rate + falling >= grazing))
            looking = active & in_range & (depth >= near)

            # how far it may have risen or fallen since, and how far noise takes a height
            may_fall, may_rise = falls * since, rises * since
            deviation = depth * camera_height
            sigma = (last_rough if last_rough > ROUGH_FROM * noise else noise) * deviation
            slack = may_fall + (ZERO if started else UNSEEN_SLOPE * depth)
            chance = BELOW_SIGMAS * sigma
            least_fall = slack + (chance if chance > shown else shown)
            deep_fall = slack + step + DEEP_SIGMAS * sigma
            least_rise = may_rise + step + ABOVE_SIGMAS * noise * deviation

            # what is seen
            fall = last_level - height
            is_below = looking & (fall > least_fall)
            is_above = looking & (-fall > least_rise)
            is_floor = looking & (fall <= least_fall) & (-fall <= least_rise)
            was_below = below > BESIDE_ROWS
            below = below + (STRONG_ROWS if fall > STRONG_FALL * least_fall else ONE) if is_below else below
            deep = deep + ONE if is_below & (fall > deep_fall) else deep
            above = above + ONE if is_above else above
            settled = is_below & (below >= STEP_ROWS) & (deep < ONE)
            step_down = settled & (fall <= step)

            gap = started & (rows_since > NO_RETURN_ROWS) & (since > criteria.gap)
            gap = gap & (last_rough < NO_RETURN_ROUGHNESS * noise)

            # why the line ends, if it does
            drop = (is_below & (deep >= DEEP_ROWS)) | (settled & (fall > step)) | (is_floor & was_below & started)
            occluded = is_above & (above >= OBSTACLE_ROWS)
            unverified = (not started) | doubtful | (rows_since > recent_rows)
            verdict = GOING if in_range else (UNVERIFIED if unverified else REACHED_RANGE)
            verdict = (NO_RETURN if gap else OCCLUDED) if occluded else verdict
            verdict = NO_RETURN if looking & missing & gap else verdict
            verdict = DROP if drop else verdict

            # and how the floor goes on, if not
            take = (is_floor | step_down) & (not drop)
            smooth = is_floor & take
            strange = (depth > latest[u]) | (height > STRANGE_HEIGHT) | (height < -STRANGE_HEIGHT) | (below > ZERO)
            skipped = (rows_since > SKIPPED_ROWS) & (since > SKIPPED_LENGTH)
            sure = take & (not doubtful) & (not (skipped if started else strange))
            away = fall if fall > ZERO else -fall
            rough = last_rough + ROUGHNESS_GAIN * (SIGMA_OF_DEVIATION * away * rate * per_deviation - last_rough)
            rough = rough if rough > noise else noise
            rough = rough if rough < ROUGH_MOST * noise else ROUGH_MOST * noise
            change = -LEVEL_GAIN * fall
            change = change if change > -may_fall else -may_fall
            change = change if change < may_rise else may_rise
            change = change if started else -fall
            inclined = last_incline + (change - last_incline * since) / INCLINE_LENGTH
            new_level = height if step_down else last_level + change

            end[u] = verdict if active else ended
            floor_row[u] = at if take else last_row
            level[u] = new_level if take else last_level
            sure_row[u] = at if sure else last_sure
            sure_level[u] = (
                sure_level[u] if doubtful else last_level
            )  # before this row, which may be the first in doubt
            incline[u] = inclined if smooth & started else last_incline
            roughness[u] = rough if smooth else last_rough
            rows_below[u], rows_deep[u] = ZERO if take else below, ZERO if take else deep
            rows_above[u] = ZERO if take else above
        follow_fall(
            at, rows, filled, lines, camera_height, noise, end, floor_row, level, brink_row, brink_level, usual, fallen
        )
        going = 0
        for u in range(many):
            end[u] = DROP if end[u] < ZERO and fallen[u] >= KERB_LENGTH else end[u]
            going += 1 if end[u] < ZERO else 0
        if going == 0:
            break
    for u in range(many):
        if end[u] == GOING:
            recent = floor_row[u] >= ZERO and (floor_row[u] - at) * outward <= recent_rows
            end[u] = REACHED_RANGE if recent and sure_row[u] == floor_row[u] else UNVERIFIED
        if sure_row[u] == floor_row[u]:
            sure_level[u] = level[u]
        if fallen[u] > ZERO and (brink_row[u] - floor_row[u]) * outward > ZERO:  # what lies beyond is no floor for sure
            floor_row[u], level[u] = brink_row[u], min(brink_level[u], usual[u])
            end[u] = end[u] if end[u] == DROP or end[u] == NO_RETURN else UNVERIFIED
            if (brink_row[u] - sure_row[u]) * outward > ZERO:
                sure_row[u], sure_level[u] = floor_row[u], level[u]
        if end[u] == DROP and floor_row[u] == NOWHERE:
            floor_row[u] = first[u]
    return end, floor_row, level, sure_row, sure_level
