"""What is published and who is alive on the network, for a short look; `cliffscan alive SERVICE` for scripts."""

import sys
import threading
import time
from typing import NamedTuple

from cliffscan.common.runtime.bus import Bus
from cliffscan.common.runtime.config import SERVICES
from cliffscan.common.runtime.stop_signal import StopSignal
from cliffscan.common.runtime.suggest import suggest
from cliffscan.plain import plain

NEWS = 1.0  # [s] in which a new session knows of every service that works
TURN = 0.1  # [s] between two looks at what is alive
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


def found_at(bus: Bus, where: str) -> str:
    """Where on the network was looked, in words, and that nobody is there at all."""
    return where if bus.connected else f"{where}, where nothing answers"


def is_token(wanted: str, token: str) -> bool:
    """Whether a liveliness token is the one of service `wanted`, or of one of several by that name: `wanted-…`."""
    return token == wanted or token.startswith(f"{wanted}-")


def alive(service: str, bus: Bus, where: str, stop: StopSignal) -> int:
    """0 as soon as `service`, or one of several by that name, works; 1 where that takes longer than news can take."""
    deadline = time.monotonic() + NEWS
    while True:
        tokens = bus.alive()
        if any(is_token(service, token) for token in tokens):
            return 0
        if time.monotonic() > deadline or stop.wait(TURN):
            print(f"cliffscan: {plain(_complaint(service, tokens, bus.robot, found_at(bus, where)))}", file=sys.stderr)
            return 1


def _complaint(service: str, tokens: set[str], robot: str, where: str) -> str:
    if not tokens:
        return f"{service} is not alive, nor is any service of {robot} {where}; is `cliffscan up` running?"
    there = ", ".join(sorted(tokens))
    return f"{service} is not alive; of {robot} there are {there}{suggest(service, {*tokens, *SERVICES} - {service})}"
