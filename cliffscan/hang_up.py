"""A terminal that hangs up, or asks to quit, ends a command as Ctrl-C does."""

import signal
from collections.abc import Iterator
from contextlib import contextmanager

from cliffscan.common.runtime.stop_signal import StopSignal

NUMBERS = (signal.SIGHUP, signal.SIGQUIT)


@contextmanager
def hang_up_stops(stop: StopSignal) -> Iterator[None]:
    """Set `stop` on SIGHUP and SIGQUIT, but for those that are ignored, as under nohup."""
    before = {number: signal.getsignal(number) for number in NUMBERS}
    heeded = {number: handler for number, handler in before.items() if handler is not signal.SIG_IGN}
    for number in heeded:
        signal.signal(number, lambda *_: stop.set())
    try:
        yield
    finally:
        for number, handler in heeded.items():
            signal.signal(number, handler)
