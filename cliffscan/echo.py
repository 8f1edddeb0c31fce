"""`cliffscan echo KEY`: print what is said on a key."""

from __future__ import annotations

import time

from cliffscan.show import line
from common.bus import Bus
from common.inbox import Inbox
from common.message import MessageError
from common.service import PATIENCE, StopSignal
from common.topics import message_at

ROOM = 256  # samples that may wait to be printed


def echo(bus: Bus, path: str, count: int, timeout: float, full: bool, stop: StopSignal) -> int:
    """Print `count` messages (0: all) said on `path`; 1 where they did not come within `timeout` [s] (0: no limit)."""
    inbox: Inbox[tuple[str, bytes]] = Inbox(ROOM)
    bus.subscribe(path, lambda key, payload: inbox.put((key, payload)))
    printed = 0
    deadline = time.monotonic() + timeout
    while not stop.is_set() and not (count and printed == count):
        if timeout and time.monotonic() > deadline:
            return 1
        arrived = inbox.get(PATIENCE)
        if arrived:
            print(_told(*arrived, full), flush=True)
            printed += 1
    return 0


def _told(path: str, payload: bytes, full: bool) -> str:
    kind = message_at(path)
    if kind is None:
        return f"{path} {len(payload)} bytes of a message that the contract does not name"
    try:
        return f"{path} {line(kind.decode(payload), full)}"
    except MessageError as error:
        return f"{path} malformed {kind.__name__}: {error}"
