"""What is published and who is alive on the network, for a short look."""

import threading
import time
from typing import NamedTuple

from cliffscan.common.runtime.bus import Bus
from cliffscan.common.runtime.service import StopSignal

NEWS = 1.0  # [s] in which a new session knows of every service that works
LOOK = 1.5  # [s] in which all that is published at 1 Hz comes at least once


class LiveKey(NamedTuple):
    """A key's path below the robot's name, and how often something was published on it."""

    path: str
    rate: float  # [Hz]


def live_keys(bus: Bus, stop: StopSignal, seconds: float = LOOK) -> list[LiveKey]:
    """The keys of the bus's robot on which something is published within `seconds` [s], in alphabetical order."""
    counts: dict[str, int] = {}
    lock = threading.Lock()

    def count(path: str, payload: bytes) -> None:  # noqa: ARG001
        with lock:
            counts[path] = counts.get(path, 0) + 1

    begun = time.monotonic()
    forget = bus.subscribe("**", count)
    stop.wait(seconds)
    forget()
    passed = time.monotonic() - begun
    with lock:
        return [LiveKey(path, counted / passed) for path, counted in sorted(counts.items())]


def is_token(wanted: str, token: str) -> bool:
    """Whether a liveliness token is the one of service `wanted`, or of one of several by that name: `wanted-…`."""
    return token == wanted or token.startswith(f"{wanted}-")
