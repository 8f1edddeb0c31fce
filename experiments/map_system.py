"""What the mapping experiment runs: all services in a simulated world, and a mapper for each scan.

The paper's scan is made of the same frames by the services in their paper profile, which are a robot of their own below
the first one's name. What they get are its frames with the floor where the mount has it, for the paper's method
neither measures the floor nor knows that the robot nods.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
from types import TracebackType
from typing import Literal, Self

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


class MapSystem:
    """A context manager: entering starts everything, leaving ends it. `feed` is there as soon as capture works."""

    def __init__(self, setting: Setting, stop: StopSignal) -> None:
        overrides = [f"capture.rate={RATE}", *setting.overrides]
        name, end = f"demo-{os.getpid()}", free_endpoint()
        plan = Plan(name, [end], overrides=overrides, world=setting.world, simulation=["--slip-noise", str(SLIP)])
        self._system = System(plan, stop)
        self._setting = setting
        self._paper_alive: set[str] = set()
        self._feed: TruthFeed | None = None
        self._exit = ExitStack()

    def __enter__(self) -> Self:
        with ExitStack() as entered:
            system = entered.enter_context(self._system)
            plan = system.plan
            paper = Plan(f"{plan.robot}/{PAPER}", plan.listen, overrides=["profile=paper"])
            for name in PAPER_SERVICES:
                system.supervisor.start(f"{PAPER}_{name}", paper.service(name))
            for name, scan in SCANS.items():
                system.supervisor.start(f"map_{name}", self._mapper(plan, name, scan))
            bus = entered.enter_context(Bus(Network("client", [plan.endpoint]), paper.robot))
            bus.watch_alive(self._changed)
            self._relay(bus)
            self._exit = entered.pop_all()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._feed:
            self._feed.close()
        self._exit.close()

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

    @property
    def feed(self) -> TruthFeed | None:
        """Where the robot truly is; None before capture works."""
        return self._feed

    def poll(self) -> None:
        """Look after the processes. Raises ConfigRefused."""
        self._system.poll()
        if self._feed is None and "capture" in self.alive:
            self._feed = TruthFeed(f"{self._system.plan.folder}/frames")

    def _mapper(self, plan: Plan, name: str, scan: str) -> list[str]:
        network = ["--robot", plan.robot, "--mode", "client", "--connect", plan.endpoint]
        own = ["--name", name, "--reach", str(REACH), "--out", str(self._setting.out / f"map_{name}")]
        module = f"examples.slam.{self._setting.mapper}"
        return [sys.executable, "-m", module, *network, "--scan", scan, *own]

    def _changed(self, service: str, alive: bool) -> None:
        (self._paper_alive.add if alive else self._paper_alive.discard)(service)

    def _relay(self, paper: Bus) -> None:
        """Say every frame again for the paper's services, with the floor where the mount has it."""
        publisher = paper.publisher(DEPTH)
        floor = {"floor": self._setting.floor}

        def again(_: str, payload: bytes) -> None:
            publisher.put(DepthImage.model_construct(**(unpack(payload, DepthImage.most_bytes()) | floor)))

        self.bus.subscribe(DEPTH.path, again)
