"""The inner loop of depth_codec's LEVELS: from planes of folded steps to depths. Its twin is tests/naive_codec.py.

In a file of its own, for numba takes 100 MiB, and who sends depth, or neither sends nor receives any, never needs it.
"""

import numpy as np
from numba import njit
from numpy.typing import NDArray

Bytes = NDArray[np.uint8]
Depth = NDArray[np.uint16]


@njit(cache=True, nogil=True)
def unfold(low: Bytes, high: Bytes, levels: Depth, depth: Depth) -> int:
    """Fill `depth` (rows, columns) [mm]; the highest place among the levels that a pixel names.

    low, high: (rows, columns), the bytes of the folded steps from each pixel's left neighbour. levels: (65536,) [mm],
    one for any place there can be, so that no pixel has to be tested.
    """
    rows, columns = depth.shape
    highest = np.uint16(0)
    for row in range(rows):
        place = np.uint16(0)
        for column in range(columns):
            folded = np.uint16(high[row, column]) << 8 | np.uint16(low[row, column])
            place = np.uint16(place + ((folded >> 1) ^ -(folded & 1)))
            if place > highest:
                highest = place
            depth[row, column] = levels[place]
    return int(highest)
