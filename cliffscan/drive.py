"""`cliffscan drive`: drive the robot with the keys of a terminal, also over ssh.

Whatever ends it, the robot is commanded to stand still before anything else is put in order. Nothing here can wait for
the terminal: its screen is drawn without blocking, or a line that hangs would keep the last velocity from changing.
"""

from __future__ import annotations

import os
import select
import sys
import termios
import threading
import time
from contextlib import suppress
from typing import Self

from cliffscan.common.contract.base_messages import Velocity
from cliffscan.common.contract.message import MessageError
from cliffscan.common.contract.topics import VELOCITY, command
from cliffscan.common.runtime.bus import Bus, Publisher
from cliffscan.common.runtime.service import USAGE_ERROR
from cliffscan.common.runtime.stop_signal import StopSignal
from cliffscan.dashboard import Board, lines, screen
from cliffscan.hang_up import hang_up_stops
from cliffscan.keys import FASTEST, FASTEST_TURN, STILL, KeyPad, Motion, Order

STDIN = 0
PERIOD = 0.05  # [s] between two velocities while driving
DRAWN_EVERY = 0.1  # [s]
SOURCE, PRIORITY = "drive", 10  # of its commands: a person at the keys outranks a program
FAREWELL = 3  # zero velocities at the end
ANSWER_WITHIN = 1.0  # [s]
ROOM = 1024  # bytes of typing that are taken at once
OPEN, CLOSE = b"\x1b[?1049h\x1b[?25l", b"\x1b[0m\x1b[?25h\x1b[?1049l"  # the alternate screen, without cursor
USUAL_SIZE = os.terminal_size((80, 24))  # of a terminal that does not report its own


def drive(bus: Bus, stop: StopSignal, linear: float, angular: float) -> int:
    """Drive until q, Ctrl-C, SIGTERM or the terminal's end, at first with `linear` [m/s] and `angular` [rad/s].

    USAGE_ERROR where standard input is no terminal, or a speed makes no sense.
    """
    refusal = _refusal(linear, angular)
    if refusal:
        print(f"cliffscan: drive: {refusal}", file=sys.stderr)
        return USAGE_ERROR
    pad = KeyPad(linear, angular)
    board = Board(bus, pad)
    # The last to be entered is the first to be left: the wheels.
    with hang_up_stops(stop), Terminal(STDIN) as terminal, Orders(bus) as orders, Wheels(bus.publisher(VELOCITY)) as w:
        _follow(stop, pad, terminal, orders, w, board)
    return 0


def _refusal(linear: float, angular: float) -> str:
    """Why this cannot drive, on one line; empty where it can."""
    if not os.isatty(STDIN):
        return "standard input is no terminal; over ssh, a terminal comes with -t"
    if not 0 < linear <= FASTEST:
        return f"linear {linear:g}: expected a speed above 0, at most {FASTEST} m/s"
    if not 0 < angular <= FASTEST_TURN:
        return f"angular {angular:g}: expected a turn rate above 0, at most {FASTEST_TURN} rad/s"
    return ""


def _follow(stop: StopSignal, pad: KeyPad, terminal: Terminal, orders: Orders, wheels: Wheels, board: Board) -> None:
    """Do what the keys say until one says quit, the terminal is gone or the process is asked to end."""
    drawn = 0.0
    while not stop.is_set():
        typed = terminal.read(wheels.due - time.monotonic())
        if typed is None:
            return
        now = time.monotonic()
        wanted = pad.feed(typed, now)
        wheels.turn(pad.wanted(now), now)
        for order in wanted:
            if order is Order.QUIT:
                return
            orders.give(order)
        if now - drawn >= DRAWN_EVERY:
            drawn = now
            terminal.draw(screen(lines(board.view(orders.note, now)), *terminal.size()))


def stand(publisher: Publisher[Velocity], source: str) -> None:
    """Command the robot to stand, several times: one command might be dropped by a full link.

    It sleeps in between, for a StopSignal that is set waits no longer.
    """
    for _ in range(FAREWELL - 1):
        _publish(publisher, STILL, source)
        time.sleep(PERIOD)
    _publish(publisher, STILL, source)


def _publish(publisher: Publisher[Velocity], motion: Motion, source: str) -> None:
    publisher.put(
        Velocity(stamp=time.time_ns(), linear=motion.linear, angular=motion.angular, source=source, priority=PRIORITY)
    )


class Wheels:
    """Publishes the velocity: at once when it changes, every PERIOD while it is wanted, and zero at the end."""

    def __init__(self, publisher: Publisher[Velocity]) -> None:
        self.due = 0.0  # [s] when turn() is to be called again
        self._publisher = publisher
        self._motion: Motion | None = None

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_why: object) -> None:
        stand(self._publisher, SOURCE)

    def turn(self, motion: Motion | None, now: float) -> None:
        """Ask for a motion, or for none at all."""
        if motion == self._motion and now < self.due:
            return
        self.due = now + PERIOD
        self._motion = motion
        if motion is not None:
            _publish(self._publisher, motion, SOURCE)


class Terminal:
    """The terminal at a file descriptor: keys come as they are typed, none is echoed, none is a signal.

    Leaving puts everything back, and forgets what was typed but not read: a held key is not meant for the shell.
    """

    def __init__(self, descriptor: int) -> None:
        self._keys = descriptor
        self._before = termios.tcgetattr(descriptor)

    def __enter__(self) -> Self:
        self._screen = _open_again(self._keys)
        raw = [*self._before[:6], list(self._before[6])]
        raw[0] &= ~(termios.IXON | termios.ICRNL | termios.INLCR | termios.IGNCR | termios.ISTRIP)
        raw[3] &= ~(termios.ICANON | termios.ECHO | termios.ISIG | termios.IEXTEN)
        raw[6][termios.VMIN], raw[6][termios.VTIME] = 1, 0
        termios.tcsetattr(self._keys, termios.TCSANOW, raw)
        termios.tcflush(self._keys, termios.TCIFLUSH)  # keys pressed before anything could be seen drive nothing
        self.draw(OPEN)
        return self

    def __exit__(self, *_: object) -> None:
        with suppress(termios.error):  # a terminal that is gone needs nothing put back
            termios.tcflush(self._keys, termios.TCIOFLUSH)  # makes room for the next line where the screen hangs
            self.draw(CLOSE)
            termios.tcsetattr(self._keys, termios.TCSANOW, self._before)
        os.close(self._screen)

    def read(self, timeout: float) -> bytes | None:
        """What was typed, perhaps nothing, within `timeout` [s]; None where the terminal is gone."""
        ready, _, _ = select.select([self._keys], [], [], max(timeout, 0.0))
        if not ready:
            return b""
        try:
            return os.read(self._keys, ROOM) or None
        except OSError:  # hung up
            return None

    def draw(self, picture: bytes) -> None:
        """Show as much as the terminal takes now; the next picture is whole again."""
        with suppress(OSError):
            os.write(self._screen, picture)

    def size(self) -> os.terminal_size:
        """Columns and rows."""
        with suppress(OSError):
            size = os.get_terminal_size(self._keys)
            return size if all(size) else USUAL_SIZE
        return USUAL_SIZE


def _open_again(descriptor: int) -> int:
    """The terminal once more, for writing without blocking: this must not change the descriptors of the shell."""
    flags = os.O_WRONLY | os.O_NONBLOCK | os.O_NOCTTY
    try:
        return os.open(os.ttyname(descriptor), flags)
    except OSError:  # another user's terminal, as after su, or one of outside a container
        return os.open("/dev/tty", flags)


class Orders:
    """Gives orders to the base without waiting for its answer; leaving waits until all are answered."""

    def __init__(self, bus: Bus) -> None:
        self.note = ""  # what became of the last one
        self._bus = bus
        self._asking: dict[Order, threading.Thread] = {}

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        for thread in self._asking.values():
            thread.join(2 * ANSWER_WITHIN)

    def give(self, order: Order) -> None:
        """Give an order, unless the same one is still unanswered: a held key gives it 30 times a second."""
        asking = self._asking.get(order)
        if asking is None or not asking.is_alive():
            self._asking[order] = threading.Thread(target=self._ask, args=(order.value,), daemon=True)
            self._asking[order].start()

    def _ask(self, name: str) -> None:
        self.note = f"{name}: asked"
        try:
            reply = self._bus.ask(command(name), {}, ANSWER_WITHIN)
        except MessageError as error:
            self.note = f"{name}: malformed reply: {error}"
            return
        if reply is None:
            self.note = f"{name}: NO ANSWER from the base"
        else:
            self.note = f"{name}: {'done' if reply.get('ok') is True else 'REFUSED'}, {reply.get('message', '')}"
