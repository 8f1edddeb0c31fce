"""Following the floor outward from the robot, in all columns of the image at once, until it ends or leaves the view."""

from __future__ import annotations

from enum import IntEnum
from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from cliffscan.common.contract.camera import Affine
from cliffscan.common.perception.point_heights import Metres

Rows = NDArray[np.int32]


class End(IntEnum):
    """Why the trace of a column ended."""

    GOING = -1  # it has not
    SIGHT = 0  # the floor goes on to where the sensor sees none
    DROP = 1  # a surface below the floor was seen
    LOST = 2  # no data where the floor must be visible
    HIDDEN = 3  # something stands in the way
    UNSEEN = 4  # the floor was not seen throughout


class Limits(NamedTuple):
    """What the sensor can do, and what a floor is."""

    near: float  # [m] of depth, from which
    far: float  # [m] and up to which the sensor measures floor
    noise: float  # [1/m] standard deviation of the inverse depth, steps included
    grazing: float  # sine of the angle to a surface below which it may return nothing
    slope: float  # rise or fall per metre of the steepest floor
    step: float  # [m] of rise or fall beyond which a surface is no floor
    gap: float  # [m] of floor without a return that is more than chance


# All state is float32, rows and counts as well: lanes of one width are what the processor's vectors are made of.
ZERO, ONE, HALF, NAN = np.float32(0.0), np.float32(1.0), np.float32(0.5), np.float32(np.nan)
BEFORE = np.float32(-2.0)
GOING, SIGHT, DROP, LOST, HIDDEN, UNSEEN = (np.float32(end) for end in End)

SURE = np.float32(2.0)  # rows that make a deep drop, or an obstacle
SETTLED = np.float32(5.0)  # rows that tell a drop from a step down that may be driven
SPECKLE = np.float32(4.0)  # rows without returns that are chance

GAIN = HALF  # of a new height in the floor's level
MEMORY = np.float32(0.3)  # [m] of floor over which its slope is known
QUICKLY = np.float32(0.2)  # gain of a new deviation in the floor's roughness
SPREAD = np.float32(1.25)  # standard deviations in a mean deviation
FEW, SOME, MANY = np.float32(2.5), np.float32(4.0), np.float32(6.0)  # standard deviations
SHORTEST = np.float32(0.2)  # [m] of hole along a beam that must be found: its far side shows over a height of
SHOWN = np.float32(0.6)  # this share of what geometry has it
STRONG, MORE = np.float32(1.25), np.float32(1.1)  # a fall so much beyond noise counts as more than one row
UNEVEN = np.float32(0.012)  # [m] that a flat floor rises and falls from row to row, and sensors err
UNSEEN_SLOPE = np.float32(0.0875)  # that the floor may have before the camera sees it
LATE = np.float32(0.05)  # [m] of depth without floor at the near end that is more than chance
UNVERIFIED = np.float32(0.05)  # [m] of floor without a return beyond which nobody knows whether it is there
DOUBT = np.float32(0.045)  # [m] above or below the plane, where what is first seen may be another floor


@njit(cache=True, error_model="numpy")
def fill(heights: Metres, row: int, step: np.float32, filled: Metres) -> None:
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
def floor_trace(
    heights: Metres,
    order: Rows,
    rates: Affine,
    camera_height: np.float32,
    limits: Metres,
) -> tuple[Metres, Metres, Metres, Metres, Metres]:
    """What became of the floor in each column: its End, and two rows with the floor's height [m] there; all (columns,).

    The first row is where floor was last seen or, of a drop before any floor, the first that was looked at; the second
    is up to where floor was seen without a gap or a doubt; -1 = nowhere.
    heights: (rows, columns) [m] as Points has them; order: the rows to look at, near to far; rates: what a ray loses in
    height per metre of depth, float32; camera_height [m]; limits: those of Limits, in their order.
    """
    near, far, noise, grazing = limits[0], limits[1], limits[2], limits[3]
    slope, step, least_gap = limits[4], limits[5], limits[6]
    columns = heights.shape[1]
    filled, level = np.empty(columns, np.float32), np.empty(columns, np.float32)
    incline, rough = np.empty(columns, np.float32), np.empty(columns, np.float32)
    end, last, sure = np.empty(columns, np.float32), np.empty(columns, np.float32), np.empty(columns, np.float32)
    sure_level = np.empty(columns, np.float32)
    doubtful = np.empty(columns, np.float32)  # 0, or the row where floor was last sure, less BEFORE
    below, deep, above = np.empty(columns, np.float32), np.empty(columns, np.float32), np.empty(columns, np.float32)
    for u in range(columns):
        level[u], incline[u], rough[u] = ZERO, ZERO, noise
        end[u], last[u], doubtful[u], sure_level[u] = GOING, GOING, ZERO, ZERO
        below[u], deep[u], above[u] = ZERO, ZERO, ZERO
    outward = ONE if rates.rows[0] < rates.rows[1] else -ONE
    spread = abs(rates.rows[1] - rates.rows[0]) / camera_height
    per_deviation = ONE / (camera_height * camera_height)
    middle = rates.columns[columns // 2]
    nearest = max(near, camera_height / max(middle + rates.rows[order[0]], grazing)) + LATE
    at = ZERO
    for index in range(len(order)):
        row = order[index]
        rate_row = rates.rows[row]
        # what the middle column's sight says for the row: a hole's far side, and a floor's rise and fall per metre
        steep = max(middle + rate_row, grazing)
        shown = min(SHOWN * SHORTEST * camera_height / (camera_height / steep + SHORTEST), step)
        shown = max(shown, UNEVEN)
        fallable = min(slope, steep - grazing)
        falls, rises = fallable * steep / (steep - fallable), slope * steep / (steep + slope)
        fill(heights, row, step, filled)
        at = np.float32(row)
        for u in range(columns):
            # the state of the trace
            h, lv, inc, ro = filled[u], level[u], incline[u], rough[u]
            la, ended_as, doubt = last[u], end[u], doubtful[u]
            bl, dp, ab = below[u], deep[u], above[u]
            active, started, missing = ended_as < ZERO, la >= ZERO, h != h

            # where the floor would be seen, and how far that is from where it last was
            rate = rates.columns[u] + rate_row
            depth = (camera_height - lv) / rate
            rows_since = (la - at) * outward if started else ONE
            since = rows_since * depth * depth * spread
            falling = inc if inc < ZERO else ZERO
            sight = (rate > ZERO) & (depth <= far) & (rate >= grazing) & ((not missing) | (rate + falling >= grazing))
            looking = active & sight & (depth >= near)

            # how far it may have risen or fallen since, and how far noise takes a height
            may_fall, may_rise = falls * since, rises * since
            deviation = depth * camera_height
            sigma = (ro if ro > FEW * noise else noise) * deviation
            slack = may_fall + (ZERO if started else UNSEEN_SLOPE * depth)
            chance = MANY * sigma
            small = slack + (chance if chance > shown else shown)
            large = slack + step + SOME * sigma
            high = may_rise + step + SOME * noise * deviation

            # what is seen instead
            fall = lv - h
            is_below = looking & (fall > small)
            is_above = looking & (-fall > high)
            is_floor = looking & (fall <= small) & (-fall <= high)
            was_below = bl > ONE
            bl = bl + (MORE if fall > STRONG * small else ONE) if is_below else bl
            dp = dp + ONE if is_below & (fall > large) else dp
            ab = ab + ONE if is_above else ab
            settled = is_below & (bl >= SETTLED) & (dp < ONE)
            step_down = settled & (fall <= step)
            gap = started & (rows_since > SPECKLE) & (since > least_gap) & (ro < SOME * noise)

            # why the trace ends, if it does
            drop = (is_below & (dp >= SURE)) | (settled & (fall > step)) | (is_floor & was_below & started)
            hidden = is_above & (ab >= SURE)
            unseen = (not started) | (doubt > ZERO) | (rows_since > SPECKLE)
            verdict = GOING if sight else (UNSEEN if unseen else SIGHT)
            verdict = (LOST if gap else HIDDEN) if hidden else verdict
            verdict = LOST if looking & missing & gap else verdict
            verdict = DROP if drop else verdict
            ended_as = verdict if active else ended_as

            # and how it goes on, if not
            take = (is_floor | step_down) & (not drop)
            smooth = is_floor & take
            strange = (depth > nearest) | (h > DOUBT) | (h < -DOUBT) | (bl > ZERO)
            skipped = (rows_since > SPECKLE) & (since > UNVERIFIED)
            new_doubt = take & (skipped if started else strange)
            away = fall if fall > ZERO else -fall
            new_rough = ro + QUICKLY * (SPREAD * away * rate * per_deviation - ro)
            new_rough = new_rough if new_rough > noise else noise
            new_rough = new_rough if new_rough < MANY * noise else MANY * noise
            change = -GAIN * fall
            change = change if change > -may_fall else -may_fall
            change = change if change < may_rise else may_rise
            change = change if started else -fall
            inc = inc + (change - inc * since) / MEMORY if smooth & started else inc
            new_level = h if step_down else lv + change

            level[u], incline[u], rough[u] = new_level if take else lv, inc, new_rough if smooth else ro
            last[u] = at if take else (BEFORE - at if looking & (la == GOING) else la)
            below[u], deep[u], above[u] = ZERO if take else bl, ZERO if take else dp, ZERO if take else ab
            before = la if started else GOING
            doubtful[u] = before - BEFORE if new_doubt & (doubt == ZERO) else doubt
            sure_level[u] = lv if doubt == ZERO else sure_level[u]
            end[u] = ended_as
        going = 0
        for u in range(columns):
            going += 1 if end[u] < ZERO else 0
        if going == 0:
            break
    for u in range(columns):
        if end[u] < ZERO:
            seen = last[u] >= ZERO and doubtful[u] == ZERO and (last[u] - at) * outward <= SPECKLE
            end[u] = SIGHT if seen else UNSEEN
        sure[u] = max(last[u], GOING) if doubtful[u] == ZERO else doubtful[u] + BEFORE
        sure_level[u] = level[u] if doubtful[u] == ZERO else sure_level[u]
        if last[u] <= BEFORE:
            last[u] = BEFORE - last[u] if end[u] == DROP else GOING
    return end, last, level, sure, sure_level
