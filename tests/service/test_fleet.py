"""Several processes of perception share robots: each is served by one, and by another after that one died.

How soon is measured: python -m benchmarks.fleet --kill.
"""

import itertools
import signal
import threading
import time

from tests import scenes
from tests.service.conftest import image, wait_until

CAMERA = scenes.camera(80, 60)
DEPTH = scenes.depth(CAMERA, [scenes.HOLE])
PERIOD = 0.04  # [s] between two frames of a robot
SECOND = 1_000_000_000  # [ns]


class Drive:
    """Robots that publish frames all the time, and when which of their scans came."""

    def __init__(self, robots):
        self.robots = robots
        self.scans = {robot.robot: [] for robot in robots}  # (time [s], seq)
        self._ended = threading.Event()
        self._subscribers = [self._listen(robot) for robot in robots]
        self._thread = threading.Thread(target=self._run)

    def __enter__(self):
        self._thread.start()
        return self

    def __exit__(self, *_):
        self._ended.set()
        self._thread.join()

    def _listen(self, robot):
        def take(sample):
            seq = int.from_bytes(sample.payload.to_bytes().partition(b"\xa3seq\xce")[2][:4], "big")
            self.scans[robot.robot].append((time.monotonic(), seq))

        return robot.session.declare_subscriber(f"{robot.robot}/scan/fused", take)

    def _run(self):
        first = 100_000  # a number that takes the same bytes in every message
        for number in itertools.count(first):
            for robot in self.robots:
                robot.put("camera/depth", image(CAMERA, DEPTH, SECOND + number, seq=number))
            if self._ended.wait(PERIOD):
                return

    def check(self):
        """No frame was answered twice, and none after a newer one."""
        for scans in self.scans.values():
            seqs = [seq for _, seq in scans]
            assert seqs == sorted(set(seqs))

    def wait_scans(self, since):
        """Wait until every robot has had some since then."""
        wait_until(lambda: all(sum(at > since for at, _ in scans) > 20 for scans in self.scans.values()))


def served(process, robots):
    """The robots that a process serves now, by what it logs."""
    with process._heard:
        lines = process.said.splitlines()
    last = {line.split()[-1]: line.split()[-2] for line in lines if " serves " in line or " leaves " in line}
    return {robot.robot for robot in robots if last.get(robot.robot) == "serves"}


def test_another_process_takes_over_the_robots_of_one_that_died(client, start):
    robots = [client, client.another(f"{client.robot}/r1"), client.another(), client.another()]
    first = start("perception", robots=["*"], wait=False)
    first.wait_said("ready for every robot")
    with Drive(robots) as drive:
        wait_until(lambda: len(served(first, robots)) == 4)
        second = start("perception", robots=["*"], wait=False)
        wait_until(lambda: len(served(first, robots)) == len(served(second, robots)) == 2)
        drive.wait_scans(time.monotonic())
        assert not served(first, robots) & served(second, robots)
        drive.check()

        second.expected = -signal.SIGKILL
        second.signal(signal.SIGKILL)
        wait_until(lambda: len(served(first, robots)) == 4)
        drive.wait_scans(time.monotonic())
        drive.check()


def test_services_of_one_robot_go_before_the_fleet(client, start):
    process = start("perception", robots=["*"], wait=False)
    process.wait_said("ready for every robot")
    with Drive([client]):
        client.wait_alive("perception")
        negative = start("negative", wait=False)
        client.wait_alive("perception", alive=False)
        process.wait_said(f"{client.robot}: another negative serves it")
        negative.signal(signal.SIGTERM)
        client.wait_alive("perception")
