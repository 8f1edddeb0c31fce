"""What `cliffscan drive` shows, as text: plain characters that any terminal can show, over any line."""

import math
import time
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from typing import Generic, NamedTuple, TypeVar

from cliffscan.common.contract.base_messages import BaseState, Odometry, Rule, SafetyState
from cliffscan.common.contract.message import Message, MessageError
from cliffscan.common.contract.topics import BASE_STATE, ODOMETRY, SAFETY, Topic
from cliffscan.common.runtime.bus import Bus
from cliffscan.keys import KeyPad, Motion
from cliffscan.plain import plain

M = TypeVar("M", bound=Message)

STALE = 0.5  # [s] after which what comes 50 times a second is old
STALE_SAFETY = 2.5  # [s] the same for what comes on change and once a second
HELP = (
    "arrows or w a s d  drive while held       space  stop",
    "+ -  speed      < >  turn rate            x  emergency stop   c  clear it",
    "r  reset odometry                         q  quit",
)
ORDINARY = ("free", "no_command", "limit")  # rules of the gate that hold while nothing is wrong
MEANING: dict[Rule, str] = {  # of a rule whose note says nothing more
    "free": "",
    "limit": "",
    "no_command": "",
    "no_base": "the base is silent: nothing moves",
    "refused": "the base's firmware is refused: its motors are never driven",
    "stopped": "emergency stop",
    "wheel_drop": "a wheel hangs in the air",
    "overcurrent": "a motor draws too much",
    "cliff": "a cliff sensor sees no floor",
    "bumper": "a bumper is pressed",
    "odometry": "the wheels' odometry cannot be believed",
    "no_scan": "the fused scan is old: it only turns",
    "obstacle": "an obstacle, an edge or ground that was never seen is in the way",
}
HOME, CLEAR_LINE, CLEAR_BELOW = "\x1b[0m\x1b[H", "\x1b[K", "\x1b[J"
STANDING_OUT, PLAIN = "\x1b[7m", "\x1b[0m"


class Aged(NamedTuple, Generic[M]):
    """A message and how long ago it came, by this machine's clock: the robot's may differ."""

    message: M
    age: float  # [s]


@dataclass(frozen=True)
class View:
    """All there is to show."""

    robot: str
    speed: float  # [m/s] that a key asks for
    turn_rate: float  # [rad/s]
    wanted: Motion | None = None
    state: Aged[BaseState] | None = None
    odometry: Aged[Odometry] | None = None
    safety: Aged[SafetyState] | None = None
    note: str = ""  # what became of the last command


class Line(NamedTuple):
    """A line of text, and whether the driver must not miss it."""

    text: str
    alarm: bool = False


def lines(view: View) -> list[Line]:
    """The view's text, the most important first: a small terminal shows the beginning."""
    return [
        Line(f"{view.robot}: {_motion(view.wanted) if view.wanted else 'not driving'}"),
        Line(f"speed     {view.speed:.2f} m/s   turn rate {view.turn_rate:.2f} rad/s"),
        *_gate(view.safety),
        _row("battery", view.state, STALE, _battery),
        _row("pose", view.odometry, STALE, _pose),
        _row("moves", view.odometry, STALE, lambda odometry: Line(_motion(Motion(*odometry.twist)))),
        Line(f"command   {plain(view.note)}" if view.note else ""),
        *(Line(text) for text in HELP),
    ]


def screen(shown: list[Line], columns: int, rows: int) -> bytes:
    """What makes a terminal of this size show these lines and nothing else, whatever it showed before."""
    cut = [(line.text[:columns], line.alarm) for line in shown[:rows]]
    text = "\r\n".join((f"{STANDING_OUT}{text}{PLAIN}" if alarm else text) + CLEAR_LINE for text, alarm in cut)
    return f"{HOME}{text}{CLEAR_BELOW}".encode("ascii", "replace")


class Latest(Generic[M]):
    """The newest good message of a topic."""

    def __init__(self, bus: Bus, topic: Topic[M]) -> None:
        self._kind = topic.message
        self._received: tuple[M, float] | None = None
        bus.subscribe(topic.path, self._arrived)

    def _arrived(self, path: str, payload: bytes) -> None:  # noqa: ARG002
        with suppress(MessageError):  # then what is shown grows old, and says so
            self._received = self._kind.decode(payload), time.monotonic()

    def aged(self, now: float) -> Aged[M] | None:
        """The message and its age at `now` [s]; None before the first."""
        received = self._received
        return Aged(received[0], max(now - received[1], 0.0)) if received else None


class Board:
    """What was received from the base, and what the keys ask for."""

    def __init__(self, bus: Bus, pad: KeyPad) -> None:
        self._robot = bus.robot
        self._pad = pad
        self._state = Latest(bus, BASE_STATE)
        self._odometry = Latest(bus, ODOMETRY)
        self._safety = Latest(bus, SAFETY)

    def view(self, note: str, now: float) -> View:
        """All there is to show at `now` [s]."""
        return View(
            robot=self._robot,
            speed=self._pad.linear,
            turn_rate=self._pad.angular,
            wanted=self._pad.wanted(now),
            state=self._state.aged(now),
            odometry=self._odometry.aged(now),
            safety=self._safety.aged(now),
            note=note,
        )


def _row(name: str, received: Aged[M] | None, stale: float, words: Callable[[M], Line]) -> Line:
    """`name`, what the message holds and how old it is."""
    if received is None:
        return Line(f"{name:10}nothing received yet", alarm=True)
    line = words(received.message)
    late = received.age > stale
    return Line(f"{name:10}{line.text}   ({'STALE, ' if late else ''}{received.age:.1f} s old)", line.alarm or late)


def _battery(state: BaseState) -> Line:
    return Line(f"{state.battery_voltage:.1f} V   {state.battery_percent:.0f} %   {plain(state.charger)}")


def _pose(odometry: Odometry) -> Line:
    x, y, theta = odometry.pose
    return Line(f"x {x:+.3f} m   y {y:+.3f} m   heading {math.degrees(theta):+.1f} deg")


def _gate(received: Aged[SafetyState] | None) -> list[Line]:
    rule = _row("gate", received, STALE_SAFETY, _rule)
    if received is None:
        return [rule]
    state = received.message
    why = state.note or MEANING[state.rule]
    return [
        rule,
        *([Line(f"  {plain(why)}", rule.alarm)] if why else []),
        Line(f"  asked   {_motion(Motion(*state.asked))}"),
        Line(f"  allowed {_motion(Motion(*state.allowed))}", alarm=state.asked != state.allowed),
    ]


def _rule(state: SafetyState) -> Line:
    distance = f", {state.distance:.2f} m to go" if state.distance >= 0 else ""
    latched = ", holds until c is pressed" if state.latched else ""
    return Line(f"{state.rule}{distance}{latched}", alarm=state.rule not in ORDINARY)


def _motion(motion: Motion) -> str:
    return f"{motion.linear:+.2f} m/s   {motion.angular:+.2f} rad/s"
