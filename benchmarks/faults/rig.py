"""The real processes in a simulated world, driven to and fro between a drop and a wall, and watched."""

import os
import random
import signal
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import NamedTuple

from benchmarks.faults.frame_relay import FrameRelay
from benchmarks.faults.intruder import Intrusion, Kind
from cliffscan.common.contract.base_messages import Velocity
from cliffscan.common.runtime.stop_signal import StopSignal
from cliffscan.simulator.world import Pose
from evaluation.processes.driven import SOURCE, DrivenRobot, driven_robot
from evaluation.processes.steering import LINEAR, Command, To

WORLD = "landing"
START = Pose(0.0, 0.2, 0.0)
EDGE = 3.0  # [m] x of the stairs' edge
ENDS = (To(EDGE - 0.45, 0.2), To(-0.9, 0.2))  # the other one is 0.6 m before the wall
SPEEDS = (0.2, 0.3, 0.5)  # [m/s]


class Shuttle:
    """Knows which end is next, and how fast to go there."""

    def __init__(self, rng: random.Random) -> None:
        self._rng = rng
        self._end = 0
        self.speed = rng.choice(SPEEDS)  # [m/s]

    def command(self, pose: Pose) -> Command:
        """What to do at this pose; at an end it turns round."""
        asked = ENDS[self._end].command(pose)
        if asked is None:
            self._end, self.speed = 1 - self._end, self._rng.choice(SPEEDS)
            asked = ENDS[self._end].command(pose) or (0.0, 0.0)
        linear, angular = asked
        return linear * self.speed / LINEAR, angular


TURNING, ONCE = 0.6, 13.0  # [rad/s], [s]
OUTAGE = 1.5  # [s] after which held commands arrive in a burst
STALE = 0.55  # [s] of the youngest command in it


class Sample(NamedTuple):
    """The robot at one moment of the simulation."""

    time: float  # [s]
    pose: Pose
    speed: float  # [m/s] of the middle between the wheels, backward too
    fallen: bool


class Rig:
    """A robot that is driven to and fro: `step` is to be called again and again. What is entered is ended at last."""

    def __init__(self, robot: DrivenRobot, relay: FrameRelay, shuttle: Shuttle, entered: ExitStack) -> None:
        self.relay = relay
        self.quiet = False  # the driver publishes nothing
        self.late = False  # what the driver publishes comes in bursts
        self._held: list[Velocity] = []  # commands that wait for the next burst
        self._turning = False
        self.robot, self._shuttle, self._entered = robot, shuttle, entered

    @property
    def speed(self) -> float:
        """How fast the driver wants to go [m/s]."""
        return self._shuttle.speed

    def step(self) -> Sample:
        """Look after the processes, look where the robot is, and drive on. Raises Interrupted."""
        self.robot.pause()
        sample = self.look()
        if not self.quiet:
            self._drive(*((0.0, TURNING) if self._turning else self._shuttle.command(sample.pose)))
        return sample

    def _drive(self, linear: float, angular: float) -> None:
        if not self.late:
            self.robot.drive(linear, angular)
            return
        self._held.append(Velocity(stamp=time.time_ns(), linear=linear, angular=angular, source=SOURCE))
        if self._held[-1].stamp - self._held[0].stamp > OUTAGE * 1e9:
            self.burst()

    def burst(self) -> None:
        """Let all commands that an outage held back arrive at once, but for the newest: those were never sent."""
        now = time.time_ns()
        for command in self._held:
            if now - command.stamp > STALE * 1e9:
                self.robot.velocity.put(command)
        self._held.clear()

    def intrude(self, kind: Kind) -> None:
        """Let a program of somebody else's onto the network; it waits for `intrusion.release()`."""
        plan = self.robot.system.plan
        self.intrusion = self._entered.enter_context(Intrusion(kind, plan.robot, plan.endpoint))

    def look(self) -> Sample:
        """Where the robot is now."""
        told = self.robot.truth()
        rims = self.robot.remote.state()["speeds"]
        return Sample(told["time"], Pose(*told["pose"]), (rims["left"] + rims["right"]) / 2, told["fallen"])

    def turn_round(self) -> None:
        """Turn on the spot once, and a little more, so that the robot sees all that is around it."""
        self._turning, end = True, self.look().time + ONCE
        while self.step().time < end:
            pass
        self._turning = False

    def put_back(self) -> None:
        """Put the robot where it started."""
        self.robot.remote.tell(f"place {START.x} {START.y} 0")

    def send(self, name: str, number: signal.Signals) -> None:
        """Send a signal to a process."""
        os.kill(self.robot.system.supervisor.children[name].pid, number)

    def start(self, name: str) -> None:
        """Start a process that was told to end."""
        plan = self.robot.system.plan
        commands = {"router": plan.router(), "capture": plan.capture(), **plan.base_processes()}
        self.robot.system.supervisor.start(name, commands.get(name) or plan.service(name))


@contextmanager
def running_rig(stop: StopSignal, rng: random.Random) -> Iterator[Rig]:
    """All processes, which run within the context. Raises TimeoutError, Interrupted."""
    with TemporaryDirectory(prefix="faults-") as folder, ExitStack() as entered:
        frames = Path(folder) / "frames"
        options = ["--frames", str(frames), "--start", *map(str, START[:2]), "0"]
        robot = entered.enter_context(driven_robot("faults", WORLD, stop, options))
        robot.wait(frames.is_socket, "the simulation")
        relay = FrameRelay(str(frames), str(robot.folder / "frames"))
        entered.callback(relay.close)
        robot.ready()
        yield Rig(robot, relay, Shuttle(rng), entered)
