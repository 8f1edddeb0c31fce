"""Frames through the workstation's part of a robot under faults: what is lost, restarted, and how memory grows.

    python -m benchmarks.soak [--frames 20000] [--coarser 1] [--kills 12] [--perception]

This process is the robot's router and its camera: it publishes a frame as soon as the last one is answered by a fused
scan, or lost. In the first quarter each process is killed in turn. Malformed frames come all the time, and now and then
a process is held for a while. Memory is looked at after that quarter, of processes that live to the end. 9 hours' worth
of frames are --frames 1000000; with --coarser 4 they are through within hours less, for services spend less on each.
out/soak.log has a line for each tenth.
"""

import argparse
import logging
import os
import signal
import time
import uuid
from collections import Counter, defaultdict
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import psutil
from rich.console import Console

from benchmarks.pipeline_fleet import drawn
from cliffscan.common.contract import topics
from cliffscan.common.contract.depth_codec import LEVELS
from cliffscan.common.contract.messages import DepthImage, LaserScan
from cliffscan.common.runtime.bus import Bus
from cliffscan.common.runtime.latest_queue import LatestQueue
from cliffscan.common.runtime.network import Network
from cliffscan.common.runtime.stop_signal import StopSignal
from cliffscan.parts import WORKSTATION
from cliffscan.system import Plan, System
from evaluation.processes.network import free_endpoint
from evaluation.processes.service_log import ServiceLog
from evaluation.tables import Table

ANSWER = 1.0  # [s] in which a frame is answered where all is well
TURN = 0.02  # [s] between two looks at the processes while no answer comes
RECOVERY = 60.0  # [s] in which frames are answered again after a fault
STARTING = 60.0  # [s]
HELD = 0.3  # [s] for which a process is stopped
HOLD_EVERY, BAD_EVERY = 997, 53  # frames
OUT = Path("out/soak.log")  # what the services say
LOOKS = 200  # at memory
TENTHS = 10  # of the frames, after each of which a line is logged
REAL_TIME = 30.0  # [Hz]
BAD: tuple[dict[str, object], ...] = ({"data": b"x"}, {"encoding": "jpeg"}, {"floor": (0.0, 0.0, 0.0, 1.0)})
MIB = 2**20


log = logging.getLogger(__name__)


class NoAnswer(Exception):
    """The processes do not recover from a fault."""


@dataclass
class Count:
    """What happened. memory: by process the frame and the resident memory [MiB] at each look."""

    sent: int = 0
    lost: int = 0  # without a fault
    lost_in_faults: int = 0
    bad: int = 0
    held: int = 0
    killed: Counter[str] = field(default_factory=Counter)
    restarted: Counter[str] = field(default_factory=Counter)
    memory: dict[str, list[tuple[int, float]]] = field(default_factory=lambda: defaultdict(list))
    seconds: float = 0.0

    def line(self) -> str:
        """How it fares so far."""
        newest = ", ".join(f"{name} {looks[-1][1]:.1f} MiB" for name, looks in self.memory.items())
        faults = f"{self.killed.total()} killed, {self.restarted.total()} restarted, {self.held} held"
        lost = f"{self.lost} lost, {self.lost_in_faults} in faults"
        pace = f"{self.sent} frames, {self.sent / self.seconds / REAL_TIME:.1f} times real time"
        return f"{pace}; {lost}; {faults}; {newest}"


class Soak:
    """One run: the processes, the camera's side of the network, and what is counted."""

    def __init__(self, system: System, robot: Bus, images: Sequence[DepthImage]) -> None:
        self.count = Count()
        self._children = system.supervisor.children
        self._system, self._images = system, images
        self._camera = robot.publisher(topics.DEPTH)
        self._answers: LatestQueue[bytes] = LatestQueue()
        robot.subscribe(topics.SCAN_FUSED.path, lambda _, payload: self._answers.put(payload))
        self._pids = {name: child.pid for name, child in self._children.items()}

    def start(self) -> None:
        """Wait for the first answer."""
        self._recover(0, STARTING)

    def run(self, frames: int, kills: int, stop: StopSignal) -> None:
        """Let the frames through, or as many as there are until told to stop."""
        count, began = self.count, time.monotonic()
        quarter, names = frames // 4, list(self._children)
        for seq in range(1, frames + 1):
            if stop.is_set():
                break
            if kills and seq <= quarter and seq % (quarter // kills or 1) == 0:
                self._kill(names[sum(count.killed.values()) % len(names)], seq)
            if seq % HOLD_EVERY == 0:
                self._hold(names[count.held % len(names)], seq)
            if seq % BAD_EVERY == 0:
                count.bad += 1
                self._put(seq, BAD[count.bad % len(BAD)])
            count.sent += 1
            count.lost += not self._answered(seq, ANSWER)
            if seq > quarter and seq % (frames // LOOKS or 1) == 0:
                self._look(seq)
            count.seconds = time.monotonic() - began
            if seq % (frames // TENTHS or 1) == 0:
                log.info("%s", count.line())

    def _put(self, seq: int, wrong: dict[str, object] | None = None) -> int:
        """Publish a frame; its stamp."""
        stamp = time.time_ns()
        image = self._images[seq % len(self._images)]
        self._camera.put(image.model_copy(update={"seq": seq, "stamp": stamp} | (wrong or {})))
        return stamp

    def _answered(self, seq: int, longest: float) -> bool:
        """Publish a frame, and wait for its fused scan."""
        stamp, deadline = self._put(seq), time.monotonic() + longest
        while time.monotonic() < deadline:
            payload = self._answers.get(TURN)
            if payload and LaserScan.decode(payload).stamp == stamp:
                return True
            self._poll()
        return False

    def _poll(self) -> None:
        """Look after the processes, and count those that were started again."""
        self._system.poll()
        for name, child in self._children.items():
            if child.pid != self._pids[name]:
                self._pids[name] = child.pid
                self.count.restarted[name] += 1

    def _kill(self, name: str, seq: int) -> None:
        self.count.killed[name] += 1
        os.kill(self._pids[name], signal.SIGKILL)
        self._recover(seq, RECOVERY)

    def _hold(self, name: str, seq: int) -> None:
        """Stop a process for a while."""
        self.count.held += 1
        os.kill(self._pids[name], signal.SIGSTOP)
        time.sleep(HELD)
        os.kill(self._pids[name], signal.SIGCONT)
        self._recover(seq, RECOVERY)

    def _recover(self, seq: int, longest: float) -> None:
        """Publish frames until one is answered. Raises NoAnswer where none is."""
        deadline = time.monotonic() + longest
        while not self._answered(seq, ANSWER / 4):
            self.count.lost_in_faults += 1
            if time.monotonic() > deadline:
                raise NoAnswer(f"no frame was answered for {longest:.0f} s, after {seq} frames")

    def _look(self, seq: int) -> None:
        for name, pid in self._pids.items():
            self.count.memory[name].append((seq, psutil.Process(pid).memory_info().rss / MIB))


def tables(count: Count) -> list[Table]:
    """The figures for people."""
    rate = count.sent / max(count.seconds, 1.0)
    row = (count.sent, f"{rate:.0f}", count.lost, count.lost_in_faults, count.bad, count.held)
    rows = [
        (name, str(count.killed[name]), str(count.restarted[name]), *memory(count.memory[name]))
        for name in sorted({*count.memory, *count.killed, *count.restarted})
    ]
    headings = ("process", "killed", "restarted", "MiB: first", "last", "most", "per 100,000 frames")
    return [
        Table("frames", ("sent", "Hz", "lost", "lost in faults", "malformed", "held"), [tuple(map(str, row))], 0),
        Table("processes", headings, rows),
    ]


def memory(looks: list[tuple[int, float]]) -> list[str]:
    """Resident memory at first, at last and at most, and its growth, fitted over the second half of the looks."""
    if not looks:
        return ["-"] * 4
    frames, resident = np.array(looks[len(looks) // 2 :]).T
    growth = 1e5 * np.polyfit(frames, resident, 1)[0] if len(frames) > 2 else np.nan
    values = [value for _, value in looks]
    return [f"{each:.1f}" for each in (values[0], values[-1], max(values), growth)]


def main() -> None:
    """Run once and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--frames", type=int, default=20_000)
    parser.add_argument("--coarser", type=int, default=1, help="how many times fewer rows and columns frames have (1)")
    parser.add_argument("--perception", action="store_true", help="one process makes all scans")
    parser.add_argument("--kills", type=int, default=12, help="in the first quarter, of each process in turn")
    options = parser.parse_args()
    logging.basicConfig(level=logging.ERROR, format="%(asctime)s %(message)s")
    log.setLevel(logging.INFO)
    robot, name, stop = free_endpoint(), f"soak-{uuid.uuid4().hex[:8]}", StopSignal()
    images = drawn(LEVELS, 1.0, options.coarser)
    OUT.parent.mkdir(parents=True, exist_ok=True)
    OUT.write_text("")
    failure = ""
    plan = Plan(name, [free_endpoint()], [robot], part=WORKSTATION, perception=options.perception)
    with (
        ServiceLog(OUT),
        Bus(Network("router", listen=[robot]), name) as bus,
        System(plan, stop) as system,
    ):
        bus.announce(f"router-{name}")
        soak = Soak(system, bus, images)
        try:
            soak.start()
            soak.run(options.frames, options.kills, stop)
        except NoAnswer as error:  # what was counted until then is worth knowing
            failure = str(error)
    for table in tables(soak.count):
        Console().print(f"\n{table.title}", table.rich())
    if failure:
        raise SystemExit(failure)


if __name__ == "__main__":
    main()
