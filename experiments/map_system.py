"""What the mapping experiment runs: all services in a simulated world, and a mapper for each scan.

The paper's scan is made of the same frames by the services in their paper profile. Their keys begin with the name of a
second perception of the robot, for which the robot's certificates are good too. What they get are its frames with the
floor where the mount has it, for the paper's method neither measures the floor nor knows that the robot nods.
"""

import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from typing import Literal

from cliffscan.common.contract.camera import FloorPlane
from cliffscan.common.contract.message import unpack
from cliffscan.common.contract.messages import DepthImage
from cliffscan.common.contract.roles import names
from cliffscan.common.contract.topics import DEPTH, SCAN_FUSED, SCAN_POSITIVE, at_workstation
from cliffscan.common.runtime.bus import Bus
from cliffscan.common.runtime.config import SENSING
from cliffscan.common.runtime.secure import CONFIG
from cliffscan.system import Plan
from evaluation.processes.hosts import Hosts, running
from experiments.run import RECORDER, Run

Mapper = Literal["odometry_map", "yag"]

PAPER = "paper"  # what the services in their paper profile are called here
PAPER_SERVICES = [name for name in SENSING if name != "capture"]
SCANS = {"positive": SCAN_POSITIVE.path, "paper": at_workstation(SCAN_FUSED).path, "fused": SCAN_FUSED.path}  # by map
REACH = 3.5  # [m] that the mappers believe: beyond, a Kinect's noise is as large as a stair
WANTED = [*SENSING, "kobuki", *(f"{PAPER}/{name}" for name in PAPER_SERVICES), *(f"slam-{name}" for name in SCANS)]
SLAM = "slam"  # the mappers' role
SLIP = 0.005  # [m] error of each wheel's way after 1 m
RATE = 10.0  # [Hz] of the frames: enough for maps, and two cores keep up


def mapping(run: Run, kind: Mapper, plan: Plan, name: str) -> list[str]:
    """The command line of what makes a map."""
    network = ["--robot", plan.robot, "--mode", "client", "--connect", plan.endpoint]
    network += ["--zenoh-config", str(plan.secure / SLAM / CONFIG)] if plan.secure else []
    own = ["--name", name, "--reach", str(REACH), "--out", str(run.out / f"map_{name}")]
    return [sys.executable, "-m", f"examples.slam.{kind}", *network, "--scan", SCANS[name], *own]


def relay(robot: Bus, paper: Bus, floor: FloorPlane) -> None:
    """Publish every frame again for the paper's services, with the floor where the mount has it."""
    publisher = paper.publisher(DEPTH)

    def again(_: str, payload: bytes) -> None:
        publisher.put(DepthImage.model_construct(**(unpack(payload, DepthImage.most_bytes()) | {"floor": floor})))

    robot.subscribe(DEPTH.path, again)


@contextmanager
def map_system(run: Run, world: str, kind: Mapper, floor: FloorPlane) -> Iterator[Hosts]:
    """All processes in a world, which run within the context. floor: as the mount has it."""
    overrides = [f"capture.rate={RATE}", *run.overrides]
    name, slip = f"demo-{os.getpid()}", ["--slip-noise", str(SLIP)]
    plan = Plan(name, overrides=overrides, world=world, simulation=slip)
    with running(plan, run.stop, run.secure) as hosts:
        system = hosts.workstation
        paper = replace(system.plan, robot=names(plan.robot)[1], overrides=["profile=paper"])
        for service in PAPER_SERVICES:
            system.supervisor.start(f"{PAPER}_{service}", paper.service(service))
        for scan in SCANS:
            system.supervisor.start(f"map_{scan}", mapping(run, kind, system.plan, scan))
        with hosts.bus(RECORDER) as frames, hosts.bus("capture", paper.robot) as bus:
            bus.watch_alive(lambda service, alive: system.changed(f"{PAPER}/{service}", alive))
            relay(frames, bus, floor)
            yield hosts
