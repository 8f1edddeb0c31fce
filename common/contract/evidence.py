"""What a beam's number rests on: the values of a scan's `intensities`."""

from enum import IntEnum


class Evidence(IntEnum):
    """Why a beam reports an obstacle."""

    NOTHING = 0
    POSITIVE = 1  # an obstacle above the floor
    DROP = 2  # a surface below the floor was seen
    FLOOR_LOST = 3  # no data where floor must be visible
    FARTHEST_FLOOR = 4  # the farthest floor point
    EXTRA = 5  # an extra input


EDGES = (Evidence.DROP, Evidence.FLOOR_LOST, Evidence.FARTHEST_FLOOR)  # where the floor ends
