"""`cliffscan play FILE.mcap`: publish what was recorded, at the times at which it came."""

import time
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from typing import NamedTuple

from cliffscan.common.contract.topics import DESCRIPTION, VELOCITY, VELOCITY_SAFE, command
from cliffscan.common.runtime.bus import Bus
from cliffscan.common.runtime.config import BASES
from cliffscan.common.runtime.raw_samples import RawPublisher, RawSample, RawSamples, key_matcher
from cliffscan.common.runtime.stop_signal import StopSignal
from cliffscan.recording.reading import Recording
from cliffscan.recording.recorded_clock import LONGEST, SECOND, Elapsed
from cliffscan.recording.words import duration, report

COMMANDS = (VELOCITY.path, VELOCITY_SAFE.path, command("**"))


class Options(NamedTuple):
    """What is played, and how."""

    keys: Sequence[str] = ("**",)
    rate: float = 1.0  # times as fast as it was
    start: float = 0.0  # [s] from the recording's beginning
    loop: bool = False
    commands: bool = False  # commands to a base too, and beside a live one


def play(bus: Bus, recording: Recording, options: Options, stop: StopSignal) -> int:
    """Play until the end or Ctrl-C; 1 where nothing was there to be played."""
    live = set(BASES) & bus.alive()
    if live and not options.commands:
        report(
            f"{' and '.join(sorted(live))} of robot {bus.robot} would take the recording for what its camera sees now:"
            " end it, play as another robot (--robot NAME), or add --commands for a base that may move"
        )
        return 1
    player = Player(bus.raw_samples(), options, stop)
    begun = time.monotonic()
    while player.play(recording.samples()) and options.loop:
        pass
    report(f"played {player.played} samples in {duration(time.monotonic() - begun)}")
    if player.left_out:
        counts = ", ".join(f"{count} of {path}" for path, count in sorted(player.left_out.items()))
        report(f"left out commands to a base: {counts}; --commands plays them")
    if player.passed_over:
        report(
            f"passed over {duration(player.passed_over)} without a sample: the clock was set, or the recorder stood"
            f" still; what is shorter than {duration(LONGEST / SECOND)} is waited for"
        )
    if recording.damage.words:
        report(f"the file is broken: {recording.damage.words}")
    if not player.played and not stop.is_set():
        report("nothing in the recording is on these keys after this start: see --keys and --start")
        return 1
    return 0


class Player:
    """Publishes samples, each on a publisher of its own key."""

    def __init__(self, samples: RawSamples, options: Options, stop: StopSignal) -> None:
        self._samples = samples
        self._options = options
        self._stop = stop
        self._wanted = key_matcher(options.keys)
        self._refused = key_matcher(() if options.commands else COMMANDS)
        self._publishers: dict[tuple[str, str], RawPublisher] = {}
        self._keep: Callable[[RawSample], None] | None = None
        self.played = 0
        self.passed_over = 0.0  # [s] the longest time without a sample that was passed over
        self.left_out: Counter[str] = Counter()

    def play(self, samples: Iterator[RawSample]) -> bool:
        """Play all samples once; False where there was none, or it was stopped."""
        began, elapsed = None, Elapsed()
        for sample in samples:
            after = elapsed.at(sample.received) - self._options.start
            self.passed_over = max(self.passed_over, elapsed.longest)
            if not self._chosen(sample.path):
                continue
            if after >= 0.0:
                began = time.monotonic() if began is None else began
                due = began + after / self._options.rate
                if self._stop.wait(max(due - time.monotonic(), 0.0)):
                    return False
            if after >= 0.0 or sample.path == DESCRIPTION.path:  # a description holds for all that follows
                self._publish(sample)
        return began is not None

    def _chosen(self, path: str) -> bool:
        wanted = self._wanted(path)
        if wanted and self._refused(path):
            self.left_out[path] += 1
            return False
        return wanted

    def _publish(self, sample: RawSample) -> None:
        kind = sample.path, sample.encoding
        if kind not in self._publishers:
            self._publishers[kind] = self._samples.publisher(*kind)
        if sample.path == DESCRIPTION.path:
            self._keep = self._keep or self._samples.latch(sample.path)
            self._keep(sample)
        self._publishers[kind].put(sample)
        self.played += 1
