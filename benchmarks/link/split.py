"""The robot's services on one host, the workstation's on the other, with the commands of docs/deployment.md."""

import json
import subprocess
import sys
import time
from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager, ExitStack
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import NamedTuple, Self

from benchmarks.link.figures import Figures, Record, figures
from benchmarks.link.hosts import Host, Hosts
from benchmarks.link.path import Link
from cliffscan.parts import PORT
from evaluation.processes.started import Started

ROBOT = "turtlebot"
BESIDE = f"{ROBOT}/workstation"
HERE = f"tcp/127.0.0.1:{PORT}"
CLIENT = ("--robot", ROBOT, "--mode", "client", "--connect", HERE)
WORLD, START = "landing", ("0", "0.2", "0")
STARTING = 180.0  # [s]
LOOK = 0.2  # [s] between two looks whether something has started
GOOD = Link(1e9)  # while all starts


class NotStarted(Exception):
    """The services did not come alive; the text says which."""


class Variant(NamedTuple):
    """Which perception runs where, and how capture is set."""

    robot: Sequence[str] = ()
    workstation: Sequence[str] = ()
    capture: Sequence[str] = ()
    beside: bool = False  # a perception on the workstation offers its scans to the robot's


class Split(AbstractContextManager["Split"]):
    """A simulated robot on one host, the rest on the other. Raises NotStarted. rate: of the frames [Hz]."""

    def __init__(self, hosts: Hosts, variant: Variant, rate: float) -> None:
        self._hosts, self._variant, self._rate = hosts, variant, rate

    def __enter__(self) -> Self:
        with ExitStack() as entered:
            folder = Path(entered.enter_context(TemporaryDirectory(prefix="link-")))
            self._hosts.set(GOOD, down=False)
            robot, workstation = (
                entered.enter_context(Started(host.within)) for host in (self._hosts.robot, self._hosts.workstation)
            )
            self._start_world(robot, folder)
            self._start_routers(robot, workstation)
            for started, names in ((robot, self._variant.robot), (workstation, self._variant.workstation)):
                for name in names:
                    started.service(name, ROBOT, HERE)
            if self._variant.beside:
                workstation.service("perception", BESIDE, HERE)
            robot.service("kobuki", ROBOT, HERE, f"kobuki.port={folder / 'kobuki'}")
            self._wait_alive("kobuki", *self._variant.robot, *self._variant.workstation)
            camera = f"capture.simulation={folder / 'frames'}", f"capture.rate={self._rate}"
            robot.service("capture", ROBOT, HERE, "capture.source=simulator", *camera, *self._variant.capture)
            self._wait_alive("capture")
            self._entered = entered.pop_all()
        return self

    def __exit__(self, *_: object) -> None:
        self._entered.close()

    def measure(self, link: Link, settling: float, seconds: float, outage: float) -> Figures:
        """Figures of `seconds` of a drive over a link, after `settling` [s]; in their midst it is down for `outage`."""
        with Probe(self._hosts.robot) as robot, Probe(self._hosts.workstation, "--drive") as workstation:
            self._hosts.set(link)
            time.sleep(settling)
            began, before = time.time_ns(), self._hosts.set()[0]["carried"]
            time.sleep((seconds - outage) / 2)
            if outage:
                self._hosts.set(down=True)
                time.sleep(outage)
                self._hosts.set(down=False)
            time.sleep((seconds - outage) / 2)
            ended, after = time.time_ns(), self._hosts.set()[0]["carried"]
            self._hosts.set(GOOD)
            return figures(robot.record(), workstation.record(), began, ended, after - before)

    def _start_world(self, robot: Started, folder: Path) -> None:
        """The base and the camera, which have no network."""
        ends = ["--link", folder / "kobuki", "--frames", folder / "frames", "--control", folder / "control"]
        robot.module("cliffscan.simulator", "--world", WORLD, "--rate", self._rate, "--start", *START, *ends)
        wait(lambda: (folder / "kobuki").exists() and (folder / "frames").exists(), "the simulation")

    def _start_routers(self, robot: Started, workstation: Started) -> None:
        router = "cliffscan", "router", "--robot", ROBOT, "--name"
        robot.module(*router, "robot", "--listen", f"tcp/0.0.0.0:{PORT}", "--insecure")
        to = f"tcp/{self._hosts.robot.address}:{PORT}"
        workstation.module(*router, "workstation", "--listen", HERE, "--connect", to)

    def _wait_alive(self, *names: str) -> None:
        for name in names:
            command = [*self._hosts.robot.within, sys.executable, "-m", "cliffscan", "alive", name, *CLIENT]
            wait(lambda command=command: _succeeds(command), name)  # type: ignore[misc]


class Probe(AbstractContextManager["Probe"]):
    """What a program on a host receives, until it is asked for its record."""

    def __init__(self, host: Host, *options: str) -> None:
        self._command = [*host.within, sys.executable, "-m", "benchmarks.link.probe", *CLIENT, *options]

    def __enter__(self) -> Self:
        self._process = subprocess.Popen(self._command, stdout=subprocess.PIPE)
        return self

    def __exit__(self, *_: object) -> None:
        self._process.kill()
        self._process.wait()

    def record(self) -> Record:
        """All that came."""
        self._process.terminate()
        said, _ = self._process.communicate()
        told: Record = json.loads(said)
        return told


def wait(holds: Callable[[], bool], what: str) -> None:
    """Wait until that holds. Raises NotStarted."""
    deadline = time.monotonic() + STARTING
    while not holds():
        if time.monotonic() > deadline:
            raise NotStarted(f"{what} did not start within {STARTING:.0f} s")
        time.sleep(LOOK)


def _succeeds(command: Sequence[str]) -> bool:
    return subprocess.run(command, check=False, capture_output=True).returncode == 0
