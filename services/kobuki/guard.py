"""The last word: a process that stops the base when the service falls silent, however it died.

It shares the service's port and receives its heartbeat on a pipe. While the heart does not beat, as when the service
hangs, it sends a stop again and again; when the pipe closes, as when the service ends or is killed, it sends the last
ones and ends.
Nothing but the standard library is imported, so that it is there at once and little can go wrong.
"""

import contextlib
import os
import select
import signal
import sys
import time

SILENCE = 0.2  # [s] without a heartbeat before the first stop
AGAIN = 0.05  # [s] between stops
LAST = 5  # stops at the end: a frame that the service left unfinished swallows the first


def watch(port: int, heart: int, stop: bytes) -> None:
    """Stand guard until the heart's pipe is closed. port, heart: file descriptors."""
    patience = SILENCE
    while True:
        ready, _, _ = select.select([heart], [], [], patience)
        if not ready:
            _send(port, stop)
            patience = AGAIN
        elif os.read(heart, 4096):
            patience = SILENCE
        else:
            break
    for _ in range(LAST):
        _send(port, stop)
        time.sleep(AGAIN)


def _send(port: int, stop: bytes) -> None:
    with contextlib.suppress(OSError):  # the port is gone; so are the wheels
        if select.select([], [port], [], AGAIN)[1]:
            os.write(port, stop)


if __name__ == "__main__":
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        signal.signal(number, signal.SIG_IGN)  # it ends when the service has ended
    watch(int(sys.argv[1]), int(sys.argv[2]), bytes.fromhex(sys.argv[3]))
