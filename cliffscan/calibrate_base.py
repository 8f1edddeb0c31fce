"""`cliffscan calibrate --base`: measure on the robot itself how late it obeys and how hard it brakes, on a free floor.

It drives to a speed, commands it to stand, and measures the way until it does, several times. By the gate's own formula
a robot that obeys after T and brakes with a goes v·T + v²/(2·a) from a speed v.
"""

import math
import select
import sys
import time
from collections import deque
from collections.abc import Callable, Sequence
from contextlib import suppress
from typing import Literal, NamedTuple

import numpy as np

from cliffscan.calibrate import NotMeasured
from cliffscan.common.contract.base_messages import Odometry, SafetyState, Velocity
from cliffscan.common.contract.message import MessageError
from cliffscan.common.contract.topics import ODOMETRY, SAFETY, VELOCITY
from cliffscan.common.runtime.bus import Bus
from cliffscan.common.runtime.config import BASES
from cliffscan.common.runtime.service import PATIENCE
from cliffscan.common.runtime.stop_signal import StopSignal
from cliffscan.drive import PRIORITY, stand
from cliffscan.hang_up import hang_up_stops
from cliffscan.plain import plain

SOURCE = "calibrate"
PERIOD = 0.02  # [s] between two commands
LONGEST_GAP = 0.15  # [s] between two messages of odometry: how it brakes in a longer one is not seen
FIRST = 5.0  # [s] in which a base that works has published its odometry
STEADY = 0.3  # [s] at one speed before it is commanded to stand, over which the speed is taken
STILL, STILL_FOR = 0.001, 0.3  # [m] or [rad] by which a robot at rest may move, and for how long [s]
LONGEST = 10.0  # [s] for one move
SHARES = (0.5, 0.75, 1.0)  # of the highest speed, each forward and backward
REACHED = 0.8  # of the speed asked for that a robot must get to
SLOWEST_START, SLOWEST_STOP, LATEST = 0.5, 0.4, 0.35  # [m/s²], [m/s²] and [s] that the free floor is planned by
SPARE = 0.1  # [m] of the free floor
SURE = 0.95  # of the deceleration that was found
DECISION = 0.02  # [s] to the gate's next decision, at most
DRIVES = ("free", "limit")  # rules by which the robot drives as asked

Kind = Literal["drive", "turn"]


class Stop(NamedTuple):
    """One stop: the speed [m/s] or [rad/s] when it was commanded, and the way [m] or [rad] from there."""

    speed: float
    way: float


class Brakes(NamedTuple):
    """What a gate must know of them: late [s], and how hard [m/s²] or [rad/s²]."""

    reaction: float
    deceleration: float


def brakes_of(stops: Sequence[Stop]) -> Brakes:
    """The latency and the deceleration by which every one of the stops is at least as short. Raises NotMeasured.

    way / speed = T + speed / (2·a) is a line over the speed; a is taken a little lower, T so that no stop lies above.
    """
    speeds, ways = np.array(stops).T
    slope = float(np.polyfit(speeds, ways / speeds, 1)[0])
    if slope <= 0.0:
        raise NotMeasured("the ways to stand do not grow with the speed; drive faster (--speed), on a floor that grips")
    deceleration = SURE / (2.0 * slope)
    late = float((ways / speeds - speeds / (2.0 * deceleration)).max())
    if late < 0.0:
        raise NotMeasured("the robot stopped sooner than it was commanded: is its odometry late?")
    return Brakes(late + DECISION, deceleration)


def fastest_on(free: float, most: float) -> float:
    """The highest speed [m/s], at most `most`, to which a slow base gets and from which it stops on `free` [m]."""
    a, b = 0.5 / SLOWEST_START + 0.5 / SLOWEST_STOP, STEADY + LATEST
    return min((math.sqrt(b * b + 4.0 * a * (free - SPARE)) - b) / (2.0 * a), most)


class Track:
    """The base's odometry as it comes, unwrapped, and the rule that the gate names."""

    def __init__(self, bus: Bus) -> None:
        self.rule, self.note = "", ""
        self.came = -math.inf  # [s]
        self.gap = 0.0  # [s] the longest between two messages since this was last set
        self._recent: deque[tuple[float, float, float]] = deque(maxlen=256)  # when [s], way [m], heading [rad]
        self._last: tuple[float, float, float] | None = None
        bus.subscribe(ODOMETRY.path, lambda _, payload: self._moved(payload))
        bus.subscribe(SAFETY.path, lambda _, payload: self._decided(payload))

    def at(self, kind: Kind) -> float:
        """How far it has gone [m], ahead less back, or turned [rad], to the left."""
        return self._recent[-1][1 if kind == "drive" else 2]

    def since(self, kind: Kind, seconds: float) -> float:
        """How far it has gone or turned in the last `seconds`."""
        recent = tuple(self._recent)  # odometry that comes meanwhile would end a walk over the deque itself
        begin = recent[-1][0] - seconds
        then = next(each for each in recent if each[0] >= begin)
        place = 1 if kind == "drive" else 2
        return recent[-1][place] - then[place]

    def _moved(self, payload: bytes) -> None:
        with suppress(MessageError):  # the gate counts and logs those
            odometry = Odometry.decode(payload)
            way, heading = self._recent[-1][1:] if self._recent else (0.0, 0.0)
            x, y, theta = odometry.pose
            if self._last:
                dx, dy, turn = x - self._last[0], y - self._last[1], math.remainder(theta - self._last[2], math.tau)
                way += dx * math.cos(theta - turn / 2) + dy * math.sin(theta - turn / 2)
                heading += turn
            self._last, self.came = odometry.pose, time.monotonic()
            if self._recent:
                self.gap = max(self.gap, odometry.stamp * 1e-9 - self._recent[-1][0])
            self._recent.append((odometry.stamp * 1e-9, way, heading))

    def _decided(self, payload: bytes) -> None:
        with suppress(MessageError):
            state = SafetyState.decode(payload)
            self.rule, self.note = state.rule, state.note


class Trials:
    """Drives the robot through the gate; whatever ends it, the robot is commanded to stand."""

    def __init__(self, bus: Bus, stop: StopSignal) -> None:
        self._track = Track(bus)
        self._velocity = bus.publisher(VELOCITY)
        self._stop = stop
        self._robot = bus.robot

    def wait(self) -> None:
        """Until the base publishes where it is. Raises NotMeasured."""
        self._until(
            lambda: self._track.came > -math.inf,
            FIRST,
            f"no odometry on {ODOMETRY.key(self._robot)}: start the base's service",
        )

    def stops(self, kind: Kind, fastest: float) -> list[Stop]:
        """Stops from several speeds, to either side in turn, so that the robot ends near where it began."""
        speeds = [side * share * fastest for share in SHARES for side in (1, -1)]
        try:
            return [self._one(kind, speed) for speed in speeds]
        finally:
            stand(self._velocity, SOURCE)

    def _one(self, kind: Kind, speed: float) -> Stop:
        """Get to a speed, hold it for a moment, and stop. Raises NotMeasured."""
        track, begin = self._track, time.monotonic()
        track.gap = 0.0
        steady_since = math.inf
        while time.monotonic() - steady_since < STEADY:
            self._command(kind, speed)
            if steady_since == math.inf and abs(track.since(kind, 0.1)) >= 0.1 * abs(speed) * REACHED:
                steady_since = time.monotonic()
            self._check(begin, f"it does not get to {abs(speed):.2f}: is max_linear or max_angular lower?")
        taken, at = abs(track.since(kind, STEADY / 2)) / (STEADY / 2), track.at(kind)
        self._command(kind, 0.0)
        stopped = time.monotonic()
        while time.monotonic() - stopped < STILL_FOR or abs(track.since(kind, STILL_FOR)) > STILL:
            self._command(kind, 0.0)
            self._check(stopped, "it does not come to rest")
        if track.gap > LONGEST_GAP:
            raise NotMeasured(f"{track.gap:.2f} s between two messages of odometry: measure where nothing else is busy")
        return Stop(taken, abs(track.at(kind) - at))

    def _command(self, kind: Kind, speed: float) -> None:
        linear, angular = (speed, 0.0) if kind == "drive" else (0.0, speed)
        stamp = time.time_ns()
        self._velocity.put(Velocity(stamp=stamp, linear=linear, angular=angular, source=SOURCE, priority=PRIORITY))
        self._stop.wait(PERIOD)

    def _check(self, since: float, why: str) -> None:
        if self._stop.is_set():
            raise NotMeasured("ended before all was measured")
        if time.monotonic() - since > LONGEST:
            note = (
                f" ({self._track.rule}{': ' if self._track.note else ''}{self._track.note})" if self._track.rule else ""
            )
            raise NotMeasured(f"{why}{note}")
        if time.monotonic() - self._track.came > 1.0:
            raise NotMeasured("the odometry has stopped")
        if self._track.rule == "obstacle":
            raise NotMeasured(
                f"the gate holds the robot back: {self._track.note}; it needs more free floor, or less --free"
            )

    def _until(self, holds: Callable[[], bool], seconds: float, why: str) -> None:
        end = time.monotonic() + seconds
        while not holds():
            if time.monotonic() > end or self._stop.is_set():
                raise NotMeasured(why)
            self._stop.wait(PERIOD)


def measure_base(bus: Bus, free: float, most: float, turn: float, stop: StopSignal) -> int:
    """Print the lines of configuration; 1 where that cannot be done, or the person does not want it.

    free: [m] ahead of the robot; most: [m/s] and turn: [rad/s] it drives and turns with at the most.
    """
    try:
        with hang_up_stops(stop):
            trials = Trials(bus, stop)
            trials.wait()
            speed = fastest_on(free, most)
            _ask(speed, free, stop)
            drives, turns = trials.stops("drive", speed), trials.stops("turn", turn)
        table = next((name for name in reversed(BASES) if name in bus.alive()), BASES[0])
        print(lines(table, brakes_of(drives), brakes_of(turns)))
    except NotMeasured as why:
        print(f"cliffscan: {plain(str(why))}", file=sys.stderr)
        return 1
    return 0


def lines(table: str, straight: Brakes, turning: Brakes) -> str:
    """The configuration of the base's service."""
    late = max(straight.reaction, turning.reaction)
    each = f"straight {straight.reaction:.2f}, turning {turning.reaction:.2f}"
    return "\n".join(
        (
            f"[{table}]",
            f"deceleration = {math.floor(100 * straight.deceleration) / 100:.2f}  # [m/s²]",
            f"angular_deceleration = {math.floor(math.degrees(turning.deceleration))}  # [deg/s²]",
            f"reaction = {math.ceil(100 * late) / 100:.2f}  # [s] {each}",
        )
    )


def _ask(speed: float, free: float, stop: StopSignal) -> None:
    """Have a person say that the floor is free. Raises NotMeasured."""
    print(
        f"The robot will drive up to {free:.1f} m ahead and back again, three times, at up to {speed:.2f} m/s, and turn"
        " on the spot.\nIs that floor free and without an edge, half a metre to either side too? Type yes: ",
        end="",
        file=sys.stderr,
        flush=True,
    )
    while not stop.is_set():
        if select.select([sys.stdin], [], [], PATIENCE)[0]:
            if sys.stdin.readline().strip().lower() == "yes":
                return
            break
    raise NotMeasured("nothing was driven")
