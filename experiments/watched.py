"""The drive as a page in the browser: round after round through the simulated landing, until Ctrl-C."""

import os
import sys
from collections.abc import Sequence
from dataclasses import replace

from cliffscan.common.contract.base_messages import Odometry, Velocity
from cliffscan.common.contract.topics import ODOMETRY, VELOCITY
from cliffscan.common.runtime.bus import Publisher
from cliffscan.common.runtime.config import SENSING
from cliffscan.system import TURN, Plan
from evaluation.processes.hosts import running
from evaluation.processes.steering import Driver, Step
from experiments.map_system import RATE, Mapper, mapping
from experiments.mapping import WORLD
from experiments.run import DRIVER, Run
from experiments.survey import COMMAND_PERIOD

MAPPED = "fused"  # the scan that is mapped
WANTED = {*SENSING, "kobuki", f"slam-{MAPPED}"}


class Rounds:
    """Leads the robot along the steps, and then along them again. done: how often it came to their end."""

    def __init__(self, steps: Sequence[Step], publisher: Publisher[Velocity]) -> None:
        self._steps = steps
        self._publisher = publisher
        self._driver = Driver(steps)
        self._commanded = 0  # [ns]
        self.done = 0

    def moved(self, odometry: Odometry) -> None:
        """The robot is where the odometry says."""
        if odometry.stamp - self._commanded < COMMAND_PERIOD:
            return
        self._commanded = odometry.stamp
        if self._driver.finished:
            self._driver = Driver(self._steps)
            self.done += 1
        linear, angular = self._driver.command(odometry.pose, odometry.stamp)
        self._publisher.put(Velocity(stamp=odometry.stamp, linear=linear, angular=angular))


def run_view(run: Run, steps: Sequence[Step], mapper: Mapper, port: int) -> None:
    """Drive and serve the page until Ctrl-C. Raises ConfigRefused, where the port is taken too."""
    overrides = [f"capture.rate={RATE}", *run.overrides]
    plan = Plan(f"demo-{os.getpid()}", overrides=overrides, world=WORLD)
    own = replace(run, out=run.out / "view")  # the map that was scored stays
    run.stop.patient = True
    with running(plan, run.stop, run.secure) as hosts, hosts.bus(DRIVER) as bus:
        system = hosts.workstation
        system.supervisor.start("view", page(system.plan, port))
        system.supervisor.start(f"map_{MAPPED}", mapping(own, mapper, system.plan, MAPPED))
        rounds = Rounds(steps, bus.publisher(VELOCITY))

        def moved(_path: str, payload: bytes) -> None:
            if hosts.alive.issuperset(WANTED):
                rounds.moved(Odometry.decode(payload))

        bus.subscribe(ODOMETRY.path, moved)
        run.console.print("The drive goes on, with a page to watch it; Ctrl-C ends both.")
        while not run.stop.wait(TURN):
            hosts.poll()


def page(plan: Plan, port: int) -> list[str]:
    """The command line of the page's server, which prints its address."""
    network = ["--robot", plan.robot, "--mode", "client", "--connect", plan.endpoint]
    network += ["--secure", str(plan.secure)] if plan.secure else []
    return [sys.executable, "-m", "cliffscan", "view", *network, "--port", str(port)]
