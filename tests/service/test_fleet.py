"""Several processes of perception share robots: each is served by one, and by another soon after that one died."""

import itertools
import signal
import threading
import time

from tests import scenes
from tests.service.conftest import image, wait_until

CAMERA = scenes.camera(80, 60)
DEPTH = scenes.depth(CAMERA, [scenes.HOLE])
PERIOD = 0.04  # [s] between two frames of a robot
TAKEN_OVER = 1.0  # [s]
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

    def longest_gap(self, robot, since):
        """[s] without a scan from a time on."""
        times = [since, *(at for at, _ in self.scans[robot] if at > since)]
        return max(later - at for at, later in itertools.pairwise(times))

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
        for robot in robots:
            robot.wait_alive("perception")
        assert len(served(first, robots)) == 4
        joined = time.monotonic()
        second = start("perception", robots=["*"], wait=False)
        wait_until(lambda: len(served(first, robots)) == len(served(second, robots)) == 2)
        drive.wait_scans(time.monotonic())
        assert not served(first, robots) & served(second, robots)
        moved, kept = served(second, robots), served(first, robots)
        assert all(drive.longest_gap(robot, joined) < TAKEN_OVER for robot in moved | kept)
        drive.check()

        second.expected = -signal.SIGKILL
        died = time.monotonic()
        second.signal(signal.SIGKILL)
        wait_until(lambda: len(served(first, robots)) == 4)
        drive.wait_scans(time.monotonic())
        assert all(drive.longest_gap(robot, died) < TAKEN_OVER for robot in moved)
        assert all(drive.longest_gap(robot, died) < TAKEN_OVER for robot in kept)
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
