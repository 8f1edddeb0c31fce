"""`cliffscan echo KEY`: print what is published on a key."""

import sys
import time

from cliffscan.common.contract.message import MessageError
from cliffscan.common.contract.topics import message_at
from cliffscan.common.runtime.bus import Bus
from cliffscan.common.runtime.latest_queue import LatestQueue
from cliffscan.common.runtime.service import PATIENCE
from cliffscan.common.runtime.stop_signal import StopSignal
from cliffscan.common.runtime.suggest import suggest
from cliffscan.live import live_keys
from cliffscan.plain import plain
from cliffscan.show import line

ROOM = 256  # samples that may wait to be printed
QUIET = 3.0  # [s] without a message, after which that is reported
NAMED = 12  # live keys that are named


def echo(bus: Bus, path: str, count: int, timeout: float, full: bool, stop: StopSignal) -> int:
    """Print `count` messages (0: all) of `path`; 1 where they did not come within `timeout` [s] (0: no limit).

    Where none comes, standard error names what else is live: at the end, or after QUIET where there is no end.
    """
    queue: LatestQueue[tuple[str, bytes]] = LatestQueue(ROOM)
    bus.subscribe(path, lambda key, payload: queue.put((key, payload)))
    printed, reported = 0, False
    begun = time.monotonic()
    while not stop.is_set() and not (count and printed == count):
        arrived = queue.get(PATIENCE)
        passed = time.monotonic() - begun
        if arrived:
            print(_printable(*arrived, full), flush=True)
            printed += 1
        if timeout and passed > timeout and not (count and printed == count):
            _complain(f"{printed} of {count or 'all'} messages" if printed else "nothing", bus, path, timeout, stop)
            return 1
        if not timeout and not printed and not reported and passed > QUIET:
            reported = True
            _complain("nothing yet", bus, path, QUIET, stop)
    return 0


def _complain(what: str, bus: Bus, path: str, seconds: float, stop: StopSignal) -> None:
    """Name on one line what did not come, and which keys are live."""
    keys = [key.path for key in live_keys(bus, stop)]
    if keys:
        more = f" and {len(keys) - NAMED} more (cliffscan list)" if len(keys) > NAMED else ""
        live = f"live keys are {', '.join(keys[:NAMED])}{more}"
    else:
        live = f"no key of {bus.robot} is live: is `cliffscan up` running?"
    meant = "" if path in keys else suggest(path, keys)
    text = f"{what} on {bus.robot}/{path} within {seconds:g} s; {live}{meant}"
    print(f"cliffscan: {plain(text)}", file=sys.stderr, flush=True)


def _printable(path: str, payload: bytes, full: bool) -> str:
    kind = message_at(path)
    if kind is None:
        return plain(f"{path} {len(payload)} bytes of a message that the contract does not name")
    try:
        return plain(f"{path} {line(kind.decode(payload), full)}")
    except MessageError as error:
        return plain(f"{path} malformed {kind.__name__}: {error}")
