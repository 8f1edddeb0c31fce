"""A recording that may go on in a further file, each of which can be read alone."""

import re
import time
from pathlib import Path
from typing import NamedTuple, Self

from cliffscan.common.runtime.raw_samples import RawSample
from cliffscan.recording.envelope import NATIVE, wrap
from cliffscan.recording.mcap_file import McapFile, RosTopic
from cliffscan.recording.ros_view import RosView
from cliffscan.services.ros2.node import Profile


class Limits(NamedTuple):
    """When a file is full; None: never."""

    size: int | None = None  # [bytes]
    seconds: float | None = None

    @property
    def split(self) -> bool:
        """Whether there may be several files."""
        return self != Limits()

    def file(self, path: Path, number: int) -> Path:
        """The name of a file: `path` itself, or FILE_0.mcap and so on where there may be several."""
        return path.with_stem(f"{path.stem}_{number}") if self.split else path

    def taken(self, path: Path) -> Path | None:
        """A file that is there and has one of the names; None where there is none."""
        if not self.split:
            return path if path.exists() else None
        name = re.compile(f"{re.escape(path.stem)}_[0-9]+{re.escape(path.suffix)}")
        return min((each for each in path.parent.glob("*") if name.fullmatch(each.name)), default=None)


class Parts:
    """Writes samples, and the ROS messages made of them. A context manager, which leaves whole files behind.

    What is latched, descriptions of the robot and ROS topics, is written again at the beginning of each file.
    images: as RosView has it; None: no ROS topics at all.
    """

    def __init__(self, path: Path, robot: str, limits: Limits, images: float | None) -> None:
        """Raises OSError where the first file cannot be made, FileExistsError where it is there."""
        self._path = path
        self._robot = robot
        self._limits = limits
        self._descriptions: dict[bytes, RawSample] = {}
        self._latched: dict[RosTopic, bytes] = {}
        self._now = 0
        self._view = RosView(robot, self._write_ros, images) if images is not None else None
        self._number = 0
        self._finished = 0
        self._file = self._open()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._file.__exit__()

    @property
    def size(self) -> int:
        """What all files hold [bytes]."""
        return self._finished + self._file.size

    @property
    def files(self) -> int:
        """How many there are."""
        return self._number

    @property
    def newest(self) -> Path:
        """The file that is being written."""
        return self._file.path

    def add(self, sample: RawSample) -> None:
        """Write a sample."""
        self._now = sample.received
        self._file.add(NATIVE, sample.received, wrap(self._robot, sample))
        if self._view:
            self._view.take(sample)

    def describe(self, sample: RawSample) -> None:
        """Write a description of the robot, unless it is known."""
        if sample.payload not in self._descriptions:
            self._descriptions[sample.payload] = sample
            self.add(sample)

    def flush(self) -> None:
        """Bring all to the disk; begin a new file where this one is full."""
        self._file.flush()
        seconds, size = self._limits.seconds, self._limits.size
        if (size and self._file.size >= size) or (seconds and time.monotonic() >= self._begun + seconds):
            full, self._file = self._file, self._open()  # where there is no next file, this one is left whole
            full.__exit__()
            self._finished += full.size
            for sample in self._descriptions.values():
                self._file.add(NATIVE, self._now, wrap(self._robot, sample._replace(received=self._now)))
            for topic, payload in self._latched.items():
                self._file.add(topic, self._now, payload)

    def _open(self) -> McapFile:
        file = McapFile(self._limits.file(self._path, self._number), self._robot)
        self._number += 1
        self._begun = time.monotonic()
        return file

    def _write_ros(self, topic: RosTopic, payload: bytes) -> None:
        if topic.profile is Profile.LATCHED:
            self._latched[topic] = payload
        self._file.add(topic, self._now, payload)
