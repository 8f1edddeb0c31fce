"""`cliffscan router`: pass on what the processes of a machine publish, to each other and to other routers."""

from __future__ import annotations

import logging
from pathlib import Path

from cliffscan.common.contract.topics import alive
from cliffscan.common.runtime.config import ServiceConfig
from cliffscan.common.runtime.network import BusError, Network, check, targets
from cliffscan.common.runtime.secure import FILES
from cliffscan.common.runtime.service import RETRY, STATUS_PERIOD, Service, connect
from cliffscan.common.runtime.stop_signal import StopSignal
from cliffscan.joined import Joined

log = logging.getLogger("cliffscan")


def route(network: Network, robot: str, name: str, stop: StopSignal) -> int:
    """Route as `router-NAME` until the process is asked to end; anew when its keys or rules are renewed.

    Zenoh reads the certificate of who listens, and the rules, when a session is opened and never again. And two routers
    that join may let nothing pass; see Joined.
    """
    token = f"router-{name}"
    joined = Joined(f"{robot}/{alive(token)}") if targets(network) else None
    opened, told = False, ""
    while not stop.is_set():
        files = Files(network)
        try:
            bus = connect(network, robot, stop)
        except BusError as error:
            if not opened:
                raise
            if str(error) != told:
                log.warning("waits for the rest of the keys, for %s", error)
                told = str(error)
            stop.wait(RETRY)
            continue
        if bus is None:
            break
        opened, told = True, ""
        with bus:
            _route_once(Service(token, ServiceConfig(), bus, stop), files, joined, stop)
    return 0


def _route_once(service: Service[ServiceConfig], files: Files, joined: Joined | None, stop: StopSignal) -> None:
    """Route until the process is asked to end, its keys are renewed, or nothing passes."""
    service.ready()
    while not stop.wait(STATUS_PERIOD):
        service.publish_status()
        if files.renewed():
            log.info("keys or rules were renewed: opening anew")
            return
        if joined and joined.is_shut(service.bus.joined, service.bus.routers()):
            log.warning("nothing passes, though the other router is reached: opening anew")
            return


class Files:
    """The files that decide how a secured router listens; none for another one."""

    def __init__(self, network: Network) -> None:
        keys = network.secure
        self._network = network
        self._files = [keys.folder / name for name in FILES] if keys else []
        self._known = self._looked_at = self._now()

    def renewed(self) -> bool:
        """Whether the files are others than at first, and can be used.

        They are copied one after the other, so those that do not belong together are about to. They are looked at once
        each time one changes.
        """
        now = self._now()
        if now in (self._known, self._looked_at):
            return False
        self._looked_at = now
        try:
            check(self._network)
        except BusError as error:
            log.warning("goes on with the keys of before, for %s", error)
            return False
        return True

    def _now(self) -> list[int | None]:
        return [_changed_at(file) for file in self._files]


def _changed_at(file: Path) -> int | None:
    """When a file was changed [ns]; None where it is not there."""
    try:
        return file.stat().st_mtime_ns
    except OSError:
        return None
