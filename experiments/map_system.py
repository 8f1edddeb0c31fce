"""What the mapping experiment runs: all services in a simulated world, and a mapper for each scan.

The paper's scan is made of the same frames by the services in their paper profile, which are a robot of their own below
the first one's name. What they get are its frames with the floor where the mount has it, for the paper's method
neither measures the floor nor knows that the robot nods.
"""

import os
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from cliffscan.common.contract.camera import FloorPlane
from cliffscan.common.contract.message import unpack
from cliffscan.common.contract.messages import DepthImage
from cliffscan.common.contract.topics import DEPTH, SCAN_FUSED, SCAN_POSITIVE
from cliffscan.common.runtime.bus import Bus, Network
from cliffscan.common.runtime.config import SENSING
from cliffscan.common.runtime.service import StopSignal
from cliffscan.supervisor import Supervisor
from cliffscan.system import Plan, System
from evaluation.processes.network import free_endpoint
from evaluation.processes.truth_feed import TruthFeed

Mapper = Literal["odometry_map", "yag"]

PAPER = "paper"  # the name, below the robot's, of the services in their paper profile
PAPER_SERVICES = [name for name in SENSING if name != "capture"]
SCANS = {"positive": SCAN_POSITIVE.path, "paper": f"{PAPER}/{SCAN_FUSED.path}", "fused": SCAN_FUSED.path}  # by map
REACH = 3.5  # [m] that the mappers believe: beyond, a Kinect's noise is as large as a stair
SLIP = 0.005  # [m] error of each wheel's way after 1 m
RATE = 10.0  # [Hz] of the frames: enough for maps, and two cores keep up


@dataclass(frozen=True)
class Setting:
    """The world to map, the mapper, the folder for what it saves, and the services' configuration."""

    world: str
    mapper: Mapper
    out: Path
    overrides: Sequence[str]  # SERVICE.KEY=VALUE
    floor: FloorPlane  # as the mount has it


def mapper(setting: Setting, plan: Plan, name: str, scan: str) -> list[str]:
    """The command line of what makes a map of a scan."""
    network = ["--robot", plan.robot, "--mode", "client", "--connect", plan.endpoint]
    own = ["--name", name, "--reach", str(REACH), "--out", str(setting.out / f"map_{name}")]
    return [sys.executable, "-m", f"examples.slam.{setting.mapper}", *network, "--scan", scan, *own]


def relay(robot: Bus, paper: Bus, floor: FloorPlane) -> None:
    """Publish every frame again for the paper's services, with the floor where the mount has it."""
    publisher = paper.publisher(DEPTH)

    def again(_: str, payload: bytes) -> None:
        publisher.put(DepthImage.model_construct(**(unpack(payload, DepthImage.most_bytes()) | {"floor": floor})))

    robot.subscribe(DEPTH.path, again)


class MapSystem:
    """The running processes. `feed` tells where the robot truly is; it is None before capture works."""

    def __init__(self, system: System, paper: Bus) -> None:
        self._system = system
        self._paper_alive: set[str] = set()
        self.feed: TruthFeed | None = None
        paper.watch_alive(self._changed)

    @property
    def bus(self) -> Bus:
        """The network, as the robot."""
        return self._system.bus

    @property
    def supervisor(self) -> Supervisor:
        """The processes."""
        return self._system.supervisor

    @property
    def alive(self) -> set[str]:
        """What works, as `negative`, `paper/negative`, `slam-fused`."""
        return self._system.alive | {f"{PAPER}/{name}" for name in self._paper_alive}

    @property
    def wanted(self) -> list[str]:
        """What must work before the robot drives."""
        paper = [f"{PAPER}/{name}" for name in PAPER_SERVICES]
        return [*SENSING, "kobuki", *paper, *(f"slam-{name}" for name in SCANS)]

    def poll(self) -> None:
        """Look after the processes. Raises ConfigRefused."""
        self._system.poll()
        if self.feed is None and "capture" in self.alive:
            self.feed = TruthFeed(f"{self._system.plan.folder}/frames")

    def _changed(self, service: str, alive: bool) -> None:
        (self._paper_alive.add if alive else self._paper_alive.discard)(service)


@contextmanager
def map_system(setting: Setting, stop: StopSignal) -> Iterator[MapSystem]:
    """All processes, which run within the context."""
    overrides = [f"capture.rate={RATE}", *setting.overrides]
    name, slip = f"demo-{os.getpid()}", ["--slip-noise", str(SLIP)]
    plan = Plan(name, [free_endpoint()], overrides=overrides, world=setting.world, simulation=slip)
    with System(plan, stop) as system:
        paper = Plan(f"{plan.robot}/{PAPER}", plan.listen, overrides=["profile=paper"])
        for service in PAPER_SERVICES:
            system.supervisor.start(f"{PAPER}_{service}", paper.service(service))
        for name, scan in SCANS.items():
            system.supervisor.start(f"map_{name}", mapper(setting, plan, name, scan))
        with Bus(Network("client", [plan.endpoint]), paper.robot) as bus:
            running = MapSystem(system, bus)
            relay(system.bus, bus, setting.floor)
            try:
                yield running
            finally:
                if running.feed:
                    running.feed.close()
