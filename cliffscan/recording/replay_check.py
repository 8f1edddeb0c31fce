"""`cliffscan replay-check FILE`: recorded depth images through today's services, compared with the recorded scans."""

import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table

from cliffscan.common.contract.description import RobotDescription
from cliffscan.common.contract.message import MessageError
from cliffscan.common.contract.messages import DepthImage, LaserScan
from cliffscan.common.contract.topics import (
    SCAN_FUSED,
    SCAN_NEGATIVE,
    SCAN_OF_METHOD,
    SCAN_POSITIVE,
    SCAN_SAFE,
    topic_at,
)
from cliffscan.common.perception.known_ground import safe_scan
from cliffscan.common.runtime.raw_samples import RawSample
from cliffscan.recording.envelope import NATIVE, wrap
from cliffscan.recording.errors import RecordingError
from cliffscan.recording.mcap_file import McapFile
from cliffscan.recording.reading import Recording
from cliffscan.recording.scan_comparison import Difference, Tally, compare
from cliffscan.recording.words import report
from cliffscan.services.negative.methods import METHODS
from cliffscan.services.perception import configs
from cliffscan.services.perception.perceive import Settings, perceive

Frame = tuple[int, int]  # seq and stamp, which a scan has of its depth image
COMBINED = tuple(topic.path for topic in (SCAN_POSITIVE, SCAN_NEGATIVE, SCAN_FUSED, SCAN_SAFE))
WIDTH = 160  # characters of a table that no terminal shows
WAITING = 64  # frames and scans that may wait for one another


class Limits(NamedTuple):
    """What two scans of a frame may differ by."""

    tolerance: float  # [m] of a number or of clear floor
    share: float  # of a scan's beams


class Worst(NamedTuple):
    """The scan that differs most."""

    share: float
    path: str
    image: DepthImage
    then: LaserScan
    now: LaserScan
    difference: Difference


class ReplayCheck:
    """Takes the samples of a recording in order, and compares each scan with the one that is made of its frame now."""

    def __init__(self, settings: Settings, limits: Limits, skipped: Sequence[str] = ()) -> None:
        """skipped: paths that are not made of a depth image alone."""
        self._given = self._settings = settings
        self.limits = limits
        self._skipped = skipped
        self._frames: dict[Frame, tuple[DepthImage, dict[str, LaserScan]]] = {}
        self._waiting: dict[tuple[str, Frame], LaserScan] = {}
        self.tallies: dict[str, Tally] = {}
        self.worst: Worst | None = None
        self.malformed = self.frames = self.alone = 0

    def take(self, sample: RawSample) -> RawSample | None:
        """Take a sample; the same with today's scan in it, or None for a scan whose frame did not come before it."""
        topic = topic_at(sample.path)
        if topic is None or topic.message not in (DepthImage, LaserScan, RobotDescription):
            return sample
        try:
            message = topic.message.decode(sample.payload)
        except MessageError:
            self.malformed += 1
            return sample
        if isinstance(message, RobotDescription) and message.body:
            self._settings = self._given._replace(positive=self._given.positive.on_body(message.body.height))
        elif isinstance(message, DepthImage):
            self._see(message)
        elif isinstance(message, LaserScan) and _is_made(sample.path) and sample.path not in self._skipped:
            now = self._scan(sample.path, message)
            return sample._replace(payload=now.encode()) if now else None
        return sample

    def finish(self) -> None:
        """The recording is through."""
        self.alone += len(self._waiting)

    def _see(self, image: DepthImage) -> None:
        """Make the scans of a frame, and compare those that came before it."""
        self.frames += 1
        scans = perceive(image, self._settings)
        by_method = {SCAN_OF_METHOD.named(name).path: scan for name, scan in scans.by_method.items()}
        made = (scans.positive, scans.negative, scans.fused, safe_scan(scans.fused))
        frame = image.seq, image.stamp
        self._frames[frame] = image, by_method | dict(zip(COMBINED, made, strict=True))
        _forget(self._frames)
        for path in self._frames[frame][1]:
            then = self._waiting.pop((path, frame), None)
            if then:
                self._scan(path, then)

    def _scan(self, path: str, then: LaserScan) -> LaserScan | None:
        """Today's scan in the place of a recorded one; None where its frame did not come yet."""
        frame = then.seq, then.stamp
        if frame not in self._frames:
            self._waiting[path, frame] = then
            self.alone += _forget(self._waiting)
            return None
        image, scans = self._frames[frame]
        now = scans[path]
        if not now.grid().matches(then.grid()):
            raise RecordingError(
                f"{path} was recorded with {then.grid()}, and is made with {now.grid()} now:"
                " give the robot's settings with --config or --set"
            )
        difference = compare(then, now, self.limits.tolerance)
        share = self.tallies.setdefault(path, Tally()).add(difference)
        if self.worst is None or share > self.worst.share:
            self.worst = Worst(share, path, image, then, now, difference)
        return now


def _is_made(path: str) -> bool:
    """Whether a scan at a path is made of a depth image."""
    methods = {SCAN_OF_METHOD.named(name).path for name in METHODS}
    return path in methods.union(COMBINED)


def _forget(held: dict[Any, Any]) -> int:
    """Drop the oldest where too many are held; how many."""
    over = max(len(held) - WAITING, 0)
    for key in list(held)[:over]:
        del held[key]
    return over


def replay_check(
    path: Path, config: tuple[Path | None, Sequence[str]], limits: Limits, picture: Path | None, renewed: Path | None
) -> int:
    """Print what differs; 1 where that is more than the limits, then with a picture beside the recording.

    renewed: file for the recording with today's scans. Raises RecordingError, ConfigError and OSError.
    """
    recording = Recording(path)
    configured = configs.load(*config)
    settings = Settings(configured["negative"], configured["positive"], tuple(METHODS))
    skipped = (SCAN_FUSED.path, SCAN_SAFE.path) if configured["fuse"].inputs else ()
    check = ReplayCheck(settings, limits, skipped)
    if renewed:
        with McapFile(renewed, recording.robot) as file:
            for sample in recording.samples():
                today = check.take(sample)
                if today:
                    file.add(NATIVE, today.received, wrap(recording.robot, today))
    else:
        for sample in recording.samples():
            check.take(sample)
    check.finish()
    return _report(check, recording, path, picture)


def _report(check: ReplayCheck, recording: Recording, path: Path, picture: Path | None) -> int:
    worst = check.worst
    if worst is None:
        has = "scans without their camera/depth" if check.alone else f"{check.frames} depth images and no scan of them"
        raise RecordingError(f"{path} holds {has}: record camera/depth and scan/** at least")
    Console(width=None if sys.stdout.isatty() else WIDTH).print(_table(check))
    if check.alone:
        report(f"{check.alone} scans came without their frame, and were not compared")
    if check.malformed:
        report(f"{check.malformed} samples are malformed, and were left out")
    if recording.damage.words:
        report(f"the file is broken: {recording.damage.words}")
    differs = worst.share > check.limits.share
    if differs:
        tolerance, share = check.limits
        report(
            f"{worst.path} of frame {worst.image.seq} differs in {100.0 * worst.share:.2f} % of its beams by more than"
            f" {tolerance:g} m or in kind, expected {100.0 * share:g} % at most"
        )
    if picture or differs:
        _draw(worst, picture or path.with_suffix(".png"))
    return 1 if differs else 0


def _table(check: ReplayCheck) -> Table:
    table = Table(box=SIMPLE_HEAD, collapse_padding=True, pad_edge=False)
    for heading in Tally.HEADINGS:
        table.add_column(heading, justify="left" if heading == Tally.HEADINGS[0] else "right")
    for path, tally in sorted(check.tallies.items()):
        table.add_row(*tally.row(path))
    return table


def _draw(worst: Worst, path: Path) -> None:
    try:
        from cliffscan.recording.worst_scan import draw
    except ModuleNotFoundError as error:
        report(f"no picture, for it needs the package {error.name}: pip install {error.name}")
        return
    draw(worst.image, worst.then, worst.now, worst.difference, worst.path, path)
    report(f"the scan that differs most is drawn in {path}")
