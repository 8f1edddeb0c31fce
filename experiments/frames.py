"""What was said of one frame, put together by its number and stamp."""

from __future__ import annotations

from collections.abc import Collection
from typing import NamedTuple

from cliffscan.common.contract.messages import DepthImage, LaserScan
from cliffscan.common.contract.topics import DEPTH, SCAN_FUSED, SCAN_NEGATIVE, SCAN_OF_METHOD, SCAN_POSITIVE

ROOM = 64  # frames that may wait for their last message


class Frame(NamedTuple):
    """A depth image and every scan that was made of it, by the path of its key, in the order of Gathering's paths."""

    image: DepthImage
    scans: dict[str, LaserScan]


class Gathering:
    """Puts messages together into frames, whatever the order in which they come.

    A frame is complete with its image and one scan on each of `paths`.
    """

    def __init__(self, paths: Collection[str]) -> None:
        self._paths = list(paths)
        self._images: dict[tuple[int, int], DepthImage] = {}
        self._scans: dict[tuple[int, int], dict[str, LaserScan]] = {}

    def take(self, path: str, message: DepthImage | LaserScan) -> Frame | None:
        """Take in what was said on `path`. The frame, where this completes one."""
        key = message.seq, message.stamp
        scans = self._scans.setdefault(key, {})
        if isinstance(message, DepthImage):
            self._images[key] = message
        else:
            scans[path] = message
        if key in self._images and scans.keys() >= set(self._paths):
            del self._scans[key]
            return Frame(self._images.pop(key), {path: scans[path] for path in self._paths})
        self._drop_oldest()
        return None

    def _drop_oldest(self) -> None:
        while len(self._scans) > ROOM:
            oldest = next(iter(self._scans))
            del self._scans[oldest]
            self._images.pop(oldest, None)


def scan_paths(methods: Collection[str]) -> list[str]:
    """The paths of all scans of a frame, in the order in which they are shown; `methods` are those of negative."""
    each = [SCAN_OF_METHOD.named(method).path for method in methods]
    return [*each, SCAN_NEGATIVE.path, SCAN_POSITIVE.path, SCAN_FUSED.path]


def tells_edges(path: str) -> bool:
    """Whether the scan on this path is to report where the floor ends."""
    return path != SCAN_POSITIVE.path and path != DEPTH.path


def name_of(path: str) -> str:
    """A short name: the method's, or `negative`, `positive`, `fused`."""
    return path.rpartition("/")[2]
