"""A simulation at the clock's pace, or slower: never faster, and never as if time had passed that has not."""

import json
import logging
import math
import time

from cliffscan.common.runtime.stop_signal import StopSignal
from cliffscan.simulator import wire
from cliffscan.simulator.frame_server import FrameServer
from cliffscan.simulator.kobuki import control
from cliffscan.simulator.kobuki.control import ControlError, is_number
from cliffscan.simulator.kobuki.runner import LOOK, Runner
from cliffscan.simulator.robot import RobotSimulation
from cliffscan.simulator.world import Pose

LONGEST = 0.05  # [s] of the simulation in one go: what the machine took longer for is left out
WINDOW = 1.0  # [s] over which the pace is measured
SLOW = 0.95  # a pace below is told
REMINDER = 10.0  # [s] between two times

log = logging.getLogger(__name__)


class Pace:
    """How fast the simulation goes: seconds of its own in one of the clock's, over the last WINDOW."""

    def __init__(self) -> None:
        self.rate = 1.0
        self._simulated = self._real = 0.0
        self._told = -math.inf

    def passed(self, simulated: float, real: float, now: float) -> None:
        """Note times that have passed together [s]."""
        self._simulated += simulated
        self._real += real
        if self._real < WINDOW:
            return
        self.rate = self._simulated / self._real
        self._simulated = self._real = 0.0
        if self.rate < SLOW and now - self._told > REMINDER:
            self._told = now
            log.warning("this machine is too slow: the simulation runs at %.0f %% of real time", 100 * self.rate)


class Live:
    """A simulation, its base's port and its frames, coupled to the clock. rate: [Hz] of the frames."""

    def __init__(self, simulation: RobotSimulation, frames: FrameServer | None, rate: float) -> None:
        self.pace = Pace()
        self._simulation, self._frames = simulation, frames
        self._period = 1.0 / rate
        self._due = 0.0  # [s] of the simulation, when the next frame is
        self._sequence = 0

    def run(self, runner: Runner, stop: StopSignal) -> None:
        """Let time pass until told to stop."""
        last = time.monotonic()
        while not stop.is_set():
            left = self._due - self._simulation.time
            runner.wait(min(LOOK, runner.base.until_next(), max(left, 0.0)))
            now = time.monotonic()
            runner.exchange(min(now - last, LONGEST))
            self.pace.passed(min(now - last, LONGEST), now - last, now)
            last = now
            if self._simulation.time >= self._due:
                self._due = max(self._due + self._period, self._simulation.time)
                self._show(time.time_ns())

    def execute(self, line: str) -> str:
        """Obey one line of the control socket: `truth`, `place X Y DEGREES`, or one of the base's own."""
        name, *words = line.split() or [""]
        if name == "truth":
            return json.dumps({"time": self._simulation.time, "rate": self.pace.rate, **truth(self._simulation)})
        if name == "place":
            if len(words) != 3 or not all(map(is_number, words)):
                raise ControlError("expected place X Y DEGREES")
            x, y, degrees = map(float, words)
            self._simulation.place(Pose(x, y, math.radians(degrees)))
            return "ok"
        answer = control.execute(self._simulation.base, line)
        return f"truth; place X Y DEGREES; {answer}" if name == "help" else answer

    def _show(self, stamp: int) -> None:
        """Send what the camera sees now, if anybody looks."""
        if self._frames is None or not self._frames.wanted:
            return
        camera = self._simulation.camera
        header = {
            "seq": self._sequence,
            "stamp": stamp,
            "time": self._simulation.time,
            "rate": self.pace.rate,
            "intrinsics": list(camera.intrinsics),
            "range": list(camera.range),
            "noise": camera.noise,
            "baseline": camera.baseline,
            "truth": truth(self._simulation),
        }
        self._frames.offer(wire.pack(header, self._simulation.frame()))
        self._sequence += 1


def truth(simulation: RobotSimulation) -> dict[str, object]:
    """What no sensor tells, as the wire has it."""
    base = simulation.base
    return {
        "pose": list(simulation.pose),
        "viewpoint": list(simulation.viewpoint()),
        "fallen": simulation.fallen,
        "bumped": simulation.bumped,
        "bumps": base.bumps,
    }
