"""What is wrong with a robot, from the tokens and statuses of its services."""

from collections.abc import Mapping
from typing import NamedTuple

from cliffscan.clocks import Clocks
from cliffscan.common.contract.messages import ServiceStatus
from cliffscan.common.runtime.config import BASES, SENSING, SERVICES

SILENT = 2.5  # [s] after which what comes once a second is missed
FEEDS = {  # by whom each service is fed, and with what
    "negative": (("capture",), "depth frame"),
    "positive": (("capture",), "depth frame"),
    "fuse": (("negative", "positive"), "pair of scans"),
}
SETTLED = 3.0  # [s] after its start a service may still have received nothing


class LastStatus(NamedTuple):
    """A service's last status, and when it came by this machine's steady clock [s]."""

    status: ServiceStatus
    at: float


class Health(NamedTuple):
    """What is known of one service: its state for a table, and what a person should know."""

    name: str
    state: str
    status: ServiceStatus | None
    latency: tuple[float, float]  # [s] by the robot's clock
    notes: list[str]


def examine(alive: set[str], last: Mapping[str, LastStatus], clocks: Clocks, now: float) -> list[Health]:
    """Every service that is there or should be, in alphabetical order. now: by the steady clock [s]."""
    silent = {name for name in alive | last.keys() if name not in last or now - last[name].at > SILENT}
    working = {name: last[name].status for name in alive if name not in silent}
    base = [name for name in BASES if name in alive | last.keys()] or BASES[:1]
    names = sorted(alive | last.keys() | {*SENSING, *base})
    return [_examined(name, name in alive, last.get(name), working, clocks, now) for name in names]


def _examined(
    name: str, alive: bool, last: LastStatus | None, working: Mapping[str, ServiceStatus], clocks: Clocks, now: float
) -> Health:
    if last is None:
        state, note = _without_status(name, alive)
        return Health(name, state, None, (0.0, 0.0), [note] if note else [])
    status, age, ahead = last.status, now - last.at, clocks.ahead(name)
    notes = [status.note] if status.note else []
    if age > SILENT:
        notes.append(f"no status for {age:.0f} s: it hangs, or the way to it is cut")
    elif alive and status.rate == 0.0 and status.uptime > SETTLED:
        notes.append(_why_idle(name, working))
    if ahead:
        side = "ahead of" if ahead > 0 else "behind"
        notes.append(f"its clock is {abs(ahead):.2f} s {side} that of {clocks.reference()}: synchronise them (chrony)")
    late = ahead if name in FEEDS else 0.0  # the others stamp by their own clock
    latency = status.latency[0] - late, status.latency[1] - late
    return Health(name, _state(status, alive), status, latency, [note for note in notes if note])


def _state(status: ServiceStatus, alive: bool) -> str:
    return "gone" if not alive and status.state == "working" else status.state


def _without_status(name: str, alive: bool) -> tuple[str, str]:
    """State and note of a service that never published its status."""
    if not alive:
        return "not found", ""
    return "alive", "it is alive, but no status of it comes" if name in (*SERVICES, *BASES) else ""


def _why_idle(name: str, working: Mapping[str, ServiceStatus]) -> str:
    """Where the chain to a service is broken that works and publishes nothing; empty where it needs none."""
    if name == "capture":
        return "no frame comes from its source"
    if name not in FEEDS:
        return ""
    feeders, what = FEEDS[name]
    for feeder in feeders:
        if feeder not in working:
            return f"no {what} arrives: {feeder} is not there"
        if working[feeder].rate == 0.0:
            return f"no {what} arrives: {feeder} publishes nothing"
    return f"no {what} arrives, though {' and '.join(feeders)} publish: is a router between them overloaded or gone?"


def missing(healths: list[Health]) -> list[str]:
    """The services that should be there and of which nothing is received."""
    return [health.name for health in healths if health.state == "not found"]
