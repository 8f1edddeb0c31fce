"""`cliffscan record FILE.mcap`: write what a robot publishes into a file."""

import errno
import logging
import shutil
import threading
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import NamedTuple

from cliffscan.common.contract.depth_codec import compile_loops
from cliffscan.common.contract.message import MessageError
from cliffscan.common.contract.topics import DESCRIPTION
from cliffscan.common.runtime.bus import Bus, encoding_of
from cliffscan.common.runtime.kept_memory import keep_freed_memory
from cliffscan.common.runtime.metrics import ServiceMetrics
from cliffscan.common.runtime.raw_samples import RawSample, key_matcher
from cliffscan.common.runtime.stop_signal import StopSignal
from cliffscan.recording.errors import RecordingError
from cliffscan.recording.parts import Limits, Parts
from cliffscan.recording.words import duration, report, size

TURN = 0.1  # [s] between two looks at what came
FLUSH = 0.5  # [s] between two chunks: a killed recorder loses no more than its last second
REPORT = 10.0  # [s] between two lines that say how large the recording is
QUIET = 3.0  # [s] without a sample, after which that is reported
ROOM = 1024  # samples that may wait to be copied
WAITING = 64 << 20  # [bytes] of samples that may wait to be written, as while a slow disk writes

NOTHING = "nothing came{}: is `cliffscan up` running, and --robot right?"

log = logging.getLogger("cliffscan")


class Options(NamedTuple):
    """What is recorded, and how."""

    path: Path
    keys: Sequence[str] = ("**",)
    limits: Limits = Limits()
    images: float | None = 1.0  # as Parts has it
    reserve: int = 0  # [bytes] that stay free on the disk
    seconds: float | None = None  # after which it ends


class Inbox:
    """Samples between the threads that receive and the one that writes."""

    def __init__(self, metrics: ServiceMetrics) -> None:
        self._metrics = metrics
        self._lock = threading.Lock()
        self._samples: list[RawSample] = []
        self._bytes = 0

    def put(self, sample: RawSample) -> None:
        """Take a sample in, unless too many wait."""
        with self._lock:
            room = self._bytes <= WAITING
            if room:
                self._bytes += len(sample.payload)
                self._samples.append(sample)
        if not room:
            self._metrics.warn_limited("dropped", "the disk is too slow for all samples: record fewer with --keys")

    def take(self) -> list[RawSample]:
        """All samples that came, in order."""
        with self._lock:
            taken, self._samples, self._bytes = self._samples, [], 0
        return taken


def check(options: Options) -> None:
    """Raises FileExistsError, OSError for a folder that is not there, RecordingError where the disk is full."""
    taken = options.limits.taken(options.path)
    if taken:
        raise FileExistsError(errno.EEXIST, "exists", str(taken))
    if _room(options) <= 0:
        left = size(options.reserve)
        raise RecordingError(
            f"{options.limits.file(options.path, 0)}: its disk has less than {left} left: make room, or lower --reserve"
        )


def record(bus: Bus, options: Options, stop: StopSignal) -> int:
    """Record until Ctrl-C; 1 where the disk became full or nothing came."""
    matches = key_matcher(options.keys)
    keep_freed_memory()  # of a chunk for the next: its pages would else cost as much as to compress it
    if options.images:
        compile_loops()
    metrics = ServiceMetrics()
    inbox = Inbox(metrics)
    with Parts(options.path, bus.robot, options.limits, options.images) as parts:
        _subscribe(bus, options.keys, inbox, metrics)
        if matches(DESCRIPTION.path):
            encoding = str(encoding_of(DESCRIPTION))
            bus.receive_latched(
                DESCRIPTION.path,
                lambda path, payload: inbox.put(RawSample(path, encoding, time.time_ns(), b"", payload)),
            )
        report(f"recording {bus.robot} to {parts.newest}, room for {size(_room(options))}; Ctrl-C ends it")
        recorder = Recorder(parts, inbox, options)
        full = recorder.run(stop)
    dropped = metrics.counts().get("dropped", 0)
    report(recorder.summary() + (f", {dropped} dropped" if dropped else ""))
    if full:
        left = size(options.reserve)
        report(f"stopped, for the disk has less than {left} left: make room, or lower --reserve")
    elif not recorder.samples:
        report(NOTHING.format(""))
    return 1 if full or not recorder.samples else 0


def _subscribe(bus: Bus, keys: Sequence[str], inbox: Inbox, metrics: ServiceMetrics) -> None:
    """Put each sample on one of the keys into the inbox once; descriptions come another way."""
    raw = bus.raw_samples()

    def refused(path: str, why: MessageError) -> None:
        metrics.warn_limited("refused", f"{path}: {why}")

    def once(number: int) -> Callable[[RawSample], None]:
        """Takes what no earlier key has."""
        taken = key_matcher([DESCRIPTION.path, *keys[:number]])
        return lambda sample: None if taken(sample.path) else inbox.put(sample)

    for number, key in enumerate(keys):
        raw.subscribe(key, once(number), refused, ROOM)


def _room(options: Options) -> int:
    """How much may yet be written [bytes]."""
    return shutil.disk_usage(options.path.parent).free - options.reserve


class Recorder:
    """Writes what comes until it is stopped or the disk is full."""

    def __init__(self, parts: Parts, inbox: Inbox, options: Options) -> None:
        self._parts = parts
        self._inbox = inbox
        self._options = options
        self._begun = time.monotonic()
        self.samples = 0

    def run(self, stop: StopSignal) -> bool:
        """Whether the disk is full."""
        flushed = reported = self._begun
        quiet = False
        while True:
            ended = stop.wait(TURN) or self._over()
            self._write()
            now = time.monotonic()
            if ended or now - flushed >= FLUSH:
                flushed = now
                self._parts.flush()
                if _room(self._options) <= 0:
                    return True
            if ended:
                return False
            if now - reported >= REPORT:
                reported = now
                log.info("%s", self._progress(now))
            if not quiet and not self.samples and now - self._begun > QUIET:
                quiet = True
                log.warning(NOTHING.format(" yet"))

    def summary(self) -> str:
        """How much was recorded, in words."""
        parts = self._parts
        more = f" and {parts.files - 1} before it" if parts.files > 1 else ""
        seconds = time.monotonic() - self._begun
        return f"{parts.newest}{more}: {size(parts.size)} in {duration(seconds)}, {self.samples} samples"

    def _over(self) -> bool:
        seconds = self._options.seconds
        return seconds is not None and time.monotonic() - self._begun >= seconds

    def _write(self) -> None:
        for sample in self._inbox.take():
            self.samples += 1
            if sample.path == DESCRIPTION.path:
                self._parts.describe(sample)
            else:
                self._parts.add(sample)

    def _progress(self, now: float) -> str:
        rate = max(self._parts.size / (now - self._begun), 1.0)
        return f"{self.summary()}; room for {duration(_room(self._options) / rate)} more"
