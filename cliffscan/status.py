"""`cliffscan status`: which services live, how fast and how late they are."""

from __future__ import annotations

import threading

from rich.console import Console
from rich.live import Live
from rich.table import Table

from common.bus import Bus
from common.message import MessageError
from common.messages import ServiceStatus
from common.service import StopSignal
from common.topics import status as status_topic

PERIOD = 1.2  # [s] in which every service has said how it fares


class Board:
    """The last word of every service."""

    def __init__(self, bus: Bus) -> None:
        self._bus = bus
        self._lock = threading.Lock()
        self._last: dict[str, ServiceStatus] = {}
        bus.subscribe(status_topic("*").path, self._heard)

    def _heard(self, path: str, payload: bytes) -> None:
        try:
            told = ServiceStatus.decode(payload)
        except MessageError:
            return  # the board shows what it can; the reader sees the service without a status
        with self._lock:
            self._last[path.rpartition("/")[2]] = told

    def table(self) -> Table:
        """Services, rates and latencies."""
        table = Table(title=f"{self._bus.robot}", title_justify="left")
        for heading, side in (
            ("service", "left"),
            ("state", "left"),
            ("Hz", "right"),
            ("p50 ms", "right"),
            ("p99 ms", "right"),
            ("counts", "left"),
            ("note", "left"),
        ):
            table.add_column(heading, justify=side)  # type: ignore[arg-type]
        alive = self._bus.alive()
        with self._lock:
            for name in sorted(alive | self._last.keys()):
                table.add_row(*self._row(name, name in alive))
        return table

    def _row(self, name: str, alive: bool) -> tuple[str, ...]:
        told = self._last.get(name)
        if told is None:
            return name, "alive", "", "", "", "", ""
        state = told.state if alive else "gone" if told.state == "working" else told.state
        counts = ", ".join(f"{count} {what}" for what, count in sorted(told.counts.items()))
        median, worst = (f"{1e3 * latency:.1f}" for latency in told.latency)
        return name, state, f"{told.rate:.1f}", median, worst, counts, told.note


def status(bus: Bus, watch: bool, stop: StopSignal) -> int:
    """Print the table once, or keep it up to date; 1 where no service lives."""
    board = Board(bus)
    stop.wait(PERIOD)
    table = board.table()
    console = Console()
    if not watch:
        console.print(table)
        return 0 if table.row_count else 1
    with Live(table, console=console, auto_refresh=False) as live:
        while not stop.wait(PERIOD):
            live.update(board.table(), refresh=True)
    return 0
