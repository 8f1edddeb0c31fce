"""What the keys of a terminal ask of the robot: bytes and times go in, a motion comes out; no terminal, no clock.

A terminal reports presses only, never of a release. A key that is held repeats itself, but only after 0.25 to
0.7 s, then some 30 times a second. So a press drives for FIRST_HOLD, long enough for the repeats to begin, and each
repeat for REPEAT_HOLD: the robot stops at most REPEAT_HOLD after a held key is released, FIRST_HOLD after a tapped
one. A terminal repeats only the key that was pressed last: two keys pressed in turn, forward and left, drive an arc
for as long as both last.
"""

import math
import re
from enum import Enum
from typing import NamedTuple

FIRST_HOLD = 0.5  # [s] a press drives
REPEAT_HOLD = 0.15  # [s] a repeat drives
REPEAT_WITHIN = 0.12  # [s] after a press of the same key: quicker than fingers, slower than any keyboard's repeats
SETTLE = 0.5  # [s] the robot is commanded to stand still after it was driven
FASTEST = 0.70  # [m/s] the base can do
FASTEST_TURN = 1.91  # [rad/s] above, its gyro loses the heading
STEP = 0.05  # [m/s]
TURN_STEP = 0.1  # [rad/s]

ESCAPE = "\x1b"
LONGEST = 32  # characters of an escape sequence that are kept
UNFINISHED = re.compile(r"\x1b(\[\[?[!-?]*|O[0-9;]*)?")  # Linux's own console begins F1 to F5 with ESC [ [
ARROW = re.compile(r"\x1b[\[O][0-9;]*([ABCD])")  # with Shift, Ctrl or Alt there are numbers in between
ARROWS = {"A": "up", "B": "down", "C": "right", "D": "left"}


class Order(Enum):
    """What a key asks for beside a motion; the value is the base's command."""

    QUIT = ""
    EMERGENCY_STOP = "stop"
    CLEAR_SAFETY = "clear_safety"
    RESET_ODOMETRY = "reset_odometry"


class Motion(NamedTuple):
    """How the robot shall move."""

    linear: float  # [m/s] forward
    angular: float  # [rad/s] counter-clockwise


STILL = Motion(0.0, 0.0)
FORWARD = {"up": 1, "w": 1, "down": -1, "s": -1}
LEFTWARD = {"left": 1, "a": 1, "right": -1, "d": -1}
FASTER = {"+": 1, "=": 1, "-": -1, "_": -1}
TURN_FASTER = {">": 1, ".": 1, "<": -1, ",": -1}
HALT = {" ", "\x1a"}  # Ctrl-Z too: to suspend this program is not what a driver means by it
ORDERS = {
    "q": Order.QUIT,
    "\x03": Order.QUIT,  # Ctrl-C
    "\x04": Order.QUIT,  # Ctrl-D
    "\x1c": Order.QUIT,  # Ctrl-\
    "x": Order.EMERGENCY_STOP,
    "c": Order.CLEAR_SAFETY,
    "r": Order.RESET_ODOMETRY,
}
# Clearing the emergency stop must not set free what was pressed while it held.
HALTING = {Order.QUIT, Order.EMERGENCY_STOP, Order.CLEAR_SAFETY}


class KeyReader:
    """Finds the keys in a terminal's bytes: `up`, `down`, `left`, `right`, or the key's character in lower case.

    However the bytes are cut, the same keys come out. A space or a control character ends an unfinished escape
    sequence, so that nothing can swallow a stop.
    """

    def __init__(self) -> None:
        self._sequence = ""

    def feed(self, data: bytes) -> list[str]:
        """The keys that `data` completes."""
        return [key for byte in data if (key := self._key(chr(byte)))]

    def _key(self, character: str) -> str:
        if character <= " " or character == "\x7f":
            self._sequence = character if character == ESCAPE else ""
            return "" if self._sequence else character
        if not self._sequence:
            return character.lower()
        sequence = self._sequence + character
        if UNFINISHED.fullmatch(sequence):
            self._sequence = sequence[:LONGEST]
            return ""
        self._sequence = ""
        arrow = ARROW.fullmatch(sequence)
        if arrow:
            return ARROWS[arrow[1]]
        return character.lower() if len(sequence) == 2 else ""  # Escape and then a key, or a key with Alt


class Axis:
    """One direction of motion, which a key drives for a short while."""

    def __init__(self) -> None:
        self.until = -math.inf  # [s]
        self._direction = 0
        self._pressed = -math.inf

    def press(self, direction: int, now: float) -> None:
        """A key for `direction` came, pressed or repeated."""
        repeated = direction == self._direction and now - self._pressed <= REPEAT_WITHIN
        self.until = now + (REPEAT_HOLD if repeated else FIRST_HOLD)
        self._direction = direction
        self._pressed = now

    def halt(self, now: float) -> None:
        """Drive no longer; the next key is a press."""
        self.until = now
        self._direction = 0

    def at(self, now: float) -> int:
        """The direction that is driven: 1, -1 or 0."""
        return self._direction if now < self.until else 0


class KeyPad:
    """What the keys ask for, from the bytes of a terminal and the steady time [s] at which they came."""

    def __init__(self, linear: float, angular: float) -> None:
        """Begin at speeds of `linear` [m/s] and `angular` [rad/s]."""
        self.linear = linear
        self.angular = angular
        self._reader = KeyReader()
        self._forward = Axis()
        self._leftward = Axis()

    def feed(self, data: bytes, now: float) -> list[Order]:
        """Take what was typed; the orders in it, if any. Nothing that comes after quit counts."""
        orders: list[Order] = []
        for key in self._reader.feed(data):
            self._press(key, now)
            if key in ORDERS:
                orders.append(ORDERS[key])
            if Order.QUIT in orders:
                break
        return orders

    def wanted(self, now: float) -> Motion | None:
        """The motion to ask for: zero for SETTLE after the last one, then None, so that others may drive."""
        forward, leftward = self._forward.at(now), self._leftward.at(now)
        if forward or leftward:
            return Motion(forward * self.linear, leftward * self.angular)
        return STILL if now < max(self._forward.until, self._leftward.until) + SETTLE else None

    def _press(self, key: str, now: float) -> None:
        if key in FORWARD:
            self._forward.press(FORWARD[key], now)
        elif key in LEFTWARD:
            self._leftward.press(LEFTWARD[key], now)
        elif key in FASTER:
            self.linear = _stepped(self.linear, FASTER[key] * STEP, STEP, FASTEST)
        elif key in TURN_FASTER:
            self.angular = _stepped(self.angular, TURN_FASTER[key] * TURN_STEP, TURN_STEP, FASTEST_TURN)
        elif key in HALT or ORDERS.get(key) in HALTING:
            self._forward.halt(now)
            self._leftward.halt(now)


def _stepped(value: float, step: float, lowest: float, highest: float) -> float:
    """The speed one step on, within the limits; one that is below `lowest` already goes no lower."""
    return round(max(min(value, lowest), min(value + step, highest)), 3)
