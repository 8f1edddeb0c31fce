"""`cliffscan status`: which services live, how fast and how late they are, and what is wrong."""

import sys
import threading
import time

from rich.console import Console, Group
from rich.live import Live
from rich.table import Table
from rich.text import Text

from cliffscan.clocks import Clocks
from cliffscan.common.contract.message import MessageError
from cliffscan.common.contract.messages import ServiceStatus
from cliffscan.common.contract.topics import STATUS
from cliffscan.common.runtime.bus import Bus
from cliffscan.common.runtime.stop_signal import StopSignal
from cliffscan.health import Health, LastStatus, examine, missing
from cliffscan.listing import nothing_of
from cliffscan.plain import plain

PERIOD = 1.2  # [s] in which every service has published how it fares
ORDINARY = ("published", "received")  # counts of nothing odd
COLUMNS = ("service", "state", "Hz", "p50 ms", "p99 ms", "counts")
NUMBERS = ("Hz", "p50 ms", "p99 ms")


class Board:
    """The last status of every service.

    Latencies are by the robot's clock: where a clock differs from it by more than Clocks tolerates, what the service
    measured is corrected by the difference, which is noted.
    """

    def __init__(self, bus: Bus) -> None:
        self._bus = bus
        self._lock = threading.Lock()
        self._last: dict[str, LastStatus] = {}
        self._clocks = Clocks()
        bus.subscribe(STATUS.named("*").path, self._receive)

    def _receive(self, path: str, payload: bytes) -> None:
        arrival, now = time.time_ns(), time.monotonic()
        try:
            status = ServiceStatus.decode(payload)
        except MessageError:
            return  # the board shows what it can; the reader sees the service without a status
        service = path.rpartition("/")[2]
        with self._lock:
            self._last[service] = LastStatus(status, now)
            self._clocks.receive(service, status.stamp, arrival)

    def healths(self) -> list[Health]:
        """Every service; none where nothing of the robot is received."""
        alive = self._bus.alive()
        with self._lock:
            if not alive and not self._last:
                return []
            return examine(alive, self._last, self._clocks, time.monotonic())


def picture(robot: str, healths: list[Health]) -> Group:
    """A table, and below it what a person should know; no text of others is taken for markup."""
    table = Table(title=Text(robot), title_justify="left")
    for heading in COLUMNS:
        table.add_column(heading, justify="right" if heading in NUMBERS else "left")
    for health in healths:
        table.add_row(*(Text(plain(cell)) for cell in _row(health)))
    notes = [Text(plain(f"{health.name}: {note}")) for health in healths for note in health.notes]
    absent = missing(healths)
    if absent:
        remedy = "where they run, does its router join this one (cliffscan router --connect tcp/HOST:7447)?"
        notes.append(Text(f"not found: {', '.join(absent)}: {remedy}"))
    return Group(table, *notes)


def _row(health: Health) -> tuple[str, ...]:
    if health.status is None:
        return health.name, health.state, "", "", "", ""
    odd = ((what, count) for what, count in sorted(health.status.counts.items()) if what not in ORDINARY)
    median, worst = (f"{1e3 * latency:.1f}" for latency in health.latency)
    counts = ", ".join(f"{count} {what}" for what, count in odd)
    return health.name, health.state, f"{health.status.rate:.1f}", median, worst, counts


def status(bus: Bus, watch: bool, where: str, stop: StopSignal) -> int:
    """Print the table once, or keep it up to date; 1 where nothing of the robot is received.

    where: on the network was looked, in words.
    """
    board = Board(bus)
    stop.wait(PERIOD)
    console = Console()
    if not watch:
        healths = board.healths()
        if not healths:
            print(nothing_of(bus, set(bus.robots()), where), file=sys.stderr)
            return 1
        console.print(picture(bus.robot, healths))
        return 0
    with Live(console=console, auto_refresh=False) as live:
        while not stop.is_set():
            healths = board.healths()
            shown = picture(bus.robot, healths) if healths else nothing_of(bus, set(bus.robots()), where)
            live.update(shown if isinstance(shown, Group) else Text(shown), refresh=True)
            stop.wait(PERIOD)
    return 0
