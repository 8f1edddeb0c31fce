"""`cliffscan list`: the live keys of a robot, or the robots that are there."""

import sys

from cliffscan.common.contract.topics import alive, message_at
from cliffscan.common.runtime.bus import Bus
from cliffscan.common.runtime.stop_signal import StopSignal
from cliffscan.live import NEWS, found_at, live_keys
from cliffscan.plain import plain


def list_keys(bus: Bus, where: str, stop: StopSignal) -> int:
    """Print every live key of the bus's robot with its rate and message; 1 where there is none."""
    keys = live_keys(bus, stop)
    robots = bus.robots()
    tokens = sorted(robots.pop(bus.robot, set()))
    rows = [(alive(token), "", "liveliness token") for token in tokens]
    rows += [(key.path, f"{key.rate:.1f} Hz", _message(key.path)) for key in keys]
    if not rows:
        print(nothing_of(bus, set(robots), where), file=sys.stderr)
        return 1
    width = max(len(plain(path)) for path, _, _ in rows)
    for path, rate, message in rows:
        print(f"{bus.robot}/{plain(path):{width}}  {rate:>9}  {message}")
    if robots:
        print(f"other robots: {_names(set(robots))}")
    return 0


def list_robots(bus: Bus, where: str, stop: StopSignal) -> int:
    """Print every robot on the network with its services; 1 where there is none."""
    stop.wait(NEWS)
    robots = bus.robots()
    for robot, services in sorted(robots.items()):
        print(f"{plain(robot)}: {', '.join(map(plain, sorted(services)))}")
    if not robots:
        print(f"cliffscan: no robot found {found_at(bus, where)}; is `cliffscan up` running?", file=sys.stderr)
    return 0 if robots else 1


def nothing_of(bus: Bus, others: set[str], where: str) -> str:
    """A line for who looks for a robot that is not there, and what to do."""
    found = f"; other robots found: {_names(others)} (--robot NAME)" if others else ""
    return f"cliffscan: nothing of robot {bus.robot} found {found_at(bus, where)}{found}; is `cliffscan up` running?"


def _names(robots: set[str]) -> str:
    return ", ".join(plain(robot) for robot in sorted(robots))


def _message(path: str) -> str:
    kind = message_at(path)
    return kind.__name__ if kind else "a message that the contract does not name"
