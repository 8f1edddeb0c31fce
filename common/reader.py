"""A thread for each subscription and each answered path, fed through a ring of Zenoh's own.

Zenoh calls a Python function through a bounded channel, and its session waits where that is full, so that a flood on
one key would delay every other. A ring drops its oldest entry instead, in native code; a dropped request ends for its
asker.
"""

from __future__ import annotations

import logging
import threading
import time
from collections.abc import Callable
from functools import partial
from typing import Any

import zenoh

from common.pace import Pace

log = logging.getLogger(__name__)


def read(source: Any, handle: Callable[[Any], object], pace: Pace | None = None) -> None:  # noqa: ANN401
    """Call `handle` for all that comes from `source`, a declaration with a ring, until its session is closed."""
    _start(str(source.key_expr), lambda: _run(source, handle, pace))


def once(name: str, work: Callable[[], object]) -> None:
    """Do a piece of work that waits for others, beside all that is read."""
    _start(name, lambda: guarded(name, work))


def guarded(name: str, work: Callable[[], object]) -> None:
    """Do a piece of work; what goes wrong costs that piece alone."""
    try:
        work()
    except zenoh.ZError as error:  # the session was closed in the meantime
        log.debug("%s: %s", name, error)
    except Exception:
        log.exception("%s: an error of the program", name)


def _run(source: Any, handle: Callable[[Any], object], pace: Pace | None) -> None:  # noqa: ANN401
    while True:
        if pace:
            time.sleep(pace.delay(time.monotonic()))
        try:
            item = source.recv()
        except zenoh.ZError:  # the session is closed
            return
        if pace:
            pace.spend(time.monotonic())
        guarded(str(source.key_expr), partial(handle, item))


def _start(name: str, run: Callable[[], None]) -> None:
    threading.Thread(target=run, name=f"bus {name}", daemon=True).start()
