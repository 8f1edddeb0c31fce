"""A robot and a workstation, as far as an experiment has both: with keys each is behind a router of its own."""

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory

from cliffscan.common.runtime.bus import Bus
from cliffscan.common.runtime.stop_signal import StopSignal
from cliffscan.parts import ROBOT, WORKSTATION, Part
from cliffscan.secure.folder import KeyFolder
from cliffscan.supervisor import Child
from cliffscan.system import Plan, System
from evaluation.processes.network import free_endpoint


@dataclass(frozen=True)
class Hosts:
    """Where camera and base are, and where all else is; both are one without keys."""

    robot: System
    workstation: System

    @property
    def alive(self) -> set[str]:
        """The services that work, of either host."""
        return self.workstation.alive

    @property
    def children(self) -> Mapping[str, Child]:
        """All processes by name."""
        on_robot = self.robot.supervisor.children
        others = {} if self.workstation is self.robot else self.workstation.supervisor.children
        return dict(on_robot) | {
            f"{name} of the workstation" if name in on_robot else name: child for name, child in others.items()
        }

    def poll(self) -> None:
        """Look after the processes. Raises ConfigRefused."""
        self.robot.poll()
        if self.workstation is not self.robot:
            self.workstation.poll()

    def bus(self, role: str, robot: str = "") -> Bus:
        """A session at the workstation with the rights of a role. robot: the name of its keys, unless the plan's."""
        plan = self.workstation.plan
        return Bus(plan.client(role), robot or plan.robot)


@contextmanager
def running(plan: Plan, stop: StopSignal, secure: bool) -> Iterator[Hosts]:
    """The processes of a plan at free endpoints, within the context. Raises ConfigError, ConfigRefused.

    secure: with keys that are made for it, the parts of robot and workstation each on a router of its own.
    """
    if not secure:
        with System(replace(plan, listen=[free_endpoint()]), stop) as system:
            yield Hosts(system, system)
        return
    plan.check()
    near, far = (free_endpoint().replace("tcp/", "tls/") for _ in range(2))
    with TemporaryDirectory(prefix="cliffscan-keys-") as folder:
        keys = Path(folder) / "keys"
        KeyFolder(keys).init(plan.robot, [])
        robot = _part(replace(plan, listen=[near], secure=keys), ROBOT)
        workstation = _part(replace(plan, listen=[far], join=[near], world="", secure=keys), WORKSTATION)
        with System(robot, stop) as one, System(workstation, stop) as other:
            yield Hosts(one, other)


def _part(plan: Plan, part: Part) -> Plan:
    """A part of a plan, with the overrides that are its own."""
    of_part = replace(plan, part=part)
    own = {each for service in of_part.services for each in of_part.own(service)}
    return replace(of_part, overrides=[each for each in plan.overrides if each in own])
