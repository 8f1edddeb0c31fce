"""What was published of one frame, put together by its number and stamp."""

from collections.abc import Mapping
from typing import Any, NamedTuple, Self

from cliffscan.common.contract.messages import DepthImage, LaserScan
from cliffscan.common.contract.topics import DEPTH
from cliffscan.common.perception.combine import combine

ROOM = 64  # frames that may wait for their last message
PAPER = "paper"  # the scan that combines PAPER_METHODS. Paper: algorithm 3
PAPER_METHODS = ("farthest_point", "virtual_floor")
ORDER = (*PAPER_METHODS, PAPER, "near_edge", "negative", "positive", "fused")  # in which scans are shown


class Frame(NamedTuple):
    """A depth image and the scans that were made of it, by name."""

    image: DepthImage
    scans: dict[str, LaserScan]

    def with_paper(self) -> Self:
        """The same with the combination of the paper's methods among the scans, all in ORDER."""
        of_paper = [self.scans[method] for method in PAPER_METHODS]
        scans = {**self.scans, PAPER: of_paper[0].model_copy(update=combine(of_paper).arrays())}
        return self._replace(scans={name: scans[name] for name in ORDER if name in scans})


class Gathering:
    """Puts messages together into frames, whatever the order in which they come.

    A frame is complete with its image and one scan on each path of `names`, which gives the scan's name.
    """

    def __init__(self, names: Mapping[str, str]) -> None:
        self._names = names
        self._waiting: dict[tuple[int, int], dict[str, Any]] = {}  # messages by path, of each frame

    def take(self, path: str, message: DepthImage | LaserScan) -> Frame | None:
        """Take in what was published on `path`. The frame, where this completes one."""
        key = message.seq, message.stamp
        parts = self._waiting.setdefault(key, {})
        parts[path] = message
        if len(parts) > len(self._names):
            del self._waiting[key]
            return Frame(parts[DEPTH.path], {name: parts[each] for each, name in self._names.items()})
        if len(self._waiting) > ROOM:
            del self._waiting[next(iter(self._waiting))]
        return None
