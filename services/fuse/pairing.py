"""Scans of one frame find each other by its stamp and its number."""

from typing import NamedTuple

from cliffscan.common.contract.messages import LaserScan

ROOM = 64  # frames that may wait at once


class Pair(NamedTuple):
    """Both scans of one frame."""

    positive: LaserScan
    negative: LaserScan


class Pairing:
    """Holds each scan until its partner, of exactly the same stamp and number, comes, or for `timeout` [s] at most.

    Times are given by the caller [s], on any clock that does not go back.
    """

    def __init__(self, timeout: float) -> None:
        self._timeout = timeout
        self._waiting: dict[tuple[int, int], tuple[float, dict[str, LaserScan]]] = {}  # by stamp and seq

    def add(self, side: str, scan: LaserScan, now: float) -> Pair | None:
        """Take in the `positive` or `negative` scan of a frame. The pair, where this completes one."""
        frame = scan.stamp, scan.seq
        _, sides = self._waiting.setdefault(frame, (now, {}))
        sides[side] = scan
        if len(sides) < len(Pair._fields):
            return None
        del self._waiting[frame]
        return Pair(**sides)

    def drop_late(self, now: float) -> list[str]:
        """Give up frames that waited too long, or are too many; which side of each came."""
        late = [frame for frame, (since, _) in self._waiting.items() if now - since >= self._timeout]
        late += [frame for frame in list(self._waiting)[:-ROOM] if frame not in late]
        return [f"stamp {frame[0]}: only {', '.join(self._waiting.pop(frame)[1])} came" for frame in late]
