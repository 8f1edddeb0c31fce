"""A program of somebody else's that is scored beside our methods: it receives depth images and publishes scans."""

import math
import os
import shlex
import signal
import subprocess
import threading
import time
from types import TracebackType
from typing import Self

import numpy as np

from benchmarks.accuracy.frames import Frame
from cliffscan.common.contract.beam_fields import Beams
from cliffscan.common.contract.camera import Floats
from cliffscan.common.contract.depth_codec import RAW
from cliffscan.common.contract.message import MessageError
from cliffscan.common.contract.messages import DepthImage, LaserScan
from cliffscan.common.contract.topics import DEPTH
from cliffscan.common.runtime.bus import Bus
from cliffscan.common.runtime.network import Network
from evaluation.processes.network import free_endpoint

STARTING = 60.0  # [s] for a program to subscribe
FIRST = 60.0  # [s] for its first scan
DEADLINE = 2.0  # [s] for any other scan
AGAIN = 1.0  # [s] after which the first image is published again: a program may know of us later than we of it
LOOK = 0.05  # [s] between two looks whether the program still runs
ENDING = 5.0  # [s] for it to end when it is told to
MOST_SILENT = 5  # images in turn without a scan
PERIOD = 33_333_333  # [ns] between two images' stamps
STDERR = 2


class ForeignError(Exception):
    """The program cannot be scored; the text is one line that says why, and what helps."""


class ForeignProgram:
    """A running program, asked image by image. A context manager: leaving it ends the program.

    The words {endpoint} and {robot} of its command, and the variables CLIFFSCAN_ENDPOINT and CLIFFSCAN_ROBOT of its
    environment, are the Zenoh endpoint of the router that it shall connect to and the first part of all keys. It
    subscribes to ROBOT/camera/depth, and publishes a LaserScan with the stamp of each image at ROBOT/path.
    """

    def __init__(self, command: str, path: str, deadline: float = DEADLINE) -> None:
        """path: as scan/mine; deadline [s]: from an image to its scan. Raises ForeignError, BusError."""
        self.command, self.path, self._deadline = command, path, deadline
        self.asked = self.answered = 0
        self._silent = self._others = 0
        self._stamp = time.time_ns()
        self._changed = threading.Condition()
        self._scan: LaserScan | None = None
        self._refused: MessageError | None = None
        robot, endpoint = f"accuracy-{os.getpid()}", free_endpoint()
        self._bus = Bus(Network(mode="router", listen=[endpoint]), robot)
        try:
            self._images = self._bus.publisher(DEPTH)
            self._bus.subscribe(path, self._receive, refused=lambda _path, why: self._refuse(why))
            self._process = self._start(robot, endpoint)
        except BaseException:
            self._bus.__exit__()
            raise

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, where: TracebackType | None
    ) -> None:
        self._end(signal.SIGTERM)
        try:
            self._process.wait(ENDING)
        except subprocess.TimeoutExpired:
            self._end(signal.SIGKILL)
            self._process.wait()
        self._bus.__exit__()

    @property
    def note(self) -> str:
        """What a reader of its figures must know."""
        return (
            f"`{self.path}` is `{self.command}`. It was given what a DepthImage carries: each frame in millimetres, "
            f"intrinsics, range, noise and region of its camera, and the floor plane that the table names. It answered "
            f"{self.answered} of {self.asked} frames within {self._deadline:g} s; without an answer no beam counts as "
            f"seen. A number at an obstacle counts as false, for a drop is asked for."
        )

    def beams(self, frame: Frame, angles: Floats) -> Beams:
        """What it reports of a frame, at these azimuths [rad]: (beams,); NaN if nothing comes. Raises ForeignError."""
        self._stamp += PERIOD
        image = DepthImage.pack(self.asked, self._stamp, "camera", frame.depth, frame.camera, RAW)
        scan = self._ask(image) if self.answered else self._ask_first(image)
        self.asked += 1
        if scan:
            self.answered, self._silent = self.answered + 1, 0
            return at_angles(scan, angles)
        self._silent += 1
        if self._silent == MOST_SILENT:
            answered = f"it answered {self.answered} of {self.asked} so far"
            raise self._error(f"no scan of {MOST_SILENT} images in turn within {self._deadline:g} s; {answered}")
        nothing = np.full(len(angles), math.nan, np.float32)
        return Beams(ranges=nothing, intensities=np.zeros_like(nothing))

    def _start(self, robot: str, endpoint: str) -> subprocess.Popen[bytes]:
        try:
            words = shlex.split(self.command)
            words = [word.replace("{endpoint}", endpoint).replace("{robot}", robot) for word in words]
            if not words:
                raise self._error("an empty command, expected a program and its arguments")
            environment = {**os.environ, "CLIFFSCAN_ENDPOINT": endpoint, "CLIFFSCAN_ROBOT": robot}
            return subprocess.Popen(words, env=environment, stdout=STDERR, start_new_session=True)
        except ValueError as error:
            raise self._error(f"{error}: quote the command as a shell would") from error
        except OSError as error:
            raise self._error(f"it does not start: {error.strerror}") from error

    def _end(self, how: signal.Signals) -> None:
        """Signal the program and all that it has started."""
        if self._process.poll() is None:
            os.killpg(self._process.pid, how)

    def _ask_first(self, image: DepthImage) -> LaserScan:
        """Its first scan, however long it starts. Raises ForeignError."""
        deadline = time.monotonic() + STARTING
        while not self._images.has_subscribers:
            if time.monotonic() > deadline:
                raise self._error(f"it has not subscribed to {DEPTH.path} of its robot within {STARTING:g} s")
            with self._changed:
                self._changed.wait(LOOK)
            self._check_runs()
        deadline = time.monotonic() + FIRST
        while time.monotonic() < deadline:
            if scan := self._ask(image, AGAIN):
                return scan
        raise self._error(f"no scan with the stamp of an image came at {self.path} within {FIRST:g} s")

    def _ask(self, image: DepthImage, patience: float | None = None) -> LaserScan | None:
        """The scan of an image; None where none comes in time. Raises ForeignError."""
        with self._changed:
            self._scan = None
        self._images.put(image)
        deadline = time.monotonic() + (self._deadline if patience is None else patience)
        while (left := deadline - time.monotonic()) > 0.0:
            with self._changed:
                if self._changed.wait_for(lambda: self._scan or self._refused, min(left, LOOK)):
                    break
            self._check_runs()
        with self._changed:
            if self._refused:
                raise self._error(f"what it publishes at {self.path} is no LaserScan: {self._refused}")
            return self._scan

    def _check_runs(self) -> None:
        code = self._process.poll()
        if code is not None:
            raise self._error(f"it ended by itself with exit code {code}; its own lines, if any, are above")

    def _receive(self, _path: str, payload: bytes) -> None:
        try:
            scan = LaserScan.decode(payload)
        except MessageError as error:
            self._refuse(error)
            return
        with self._changed:
            if scan.stamp == self._stamp:
                self._scan = scan
                self._changed.notify_all()
            else:
                self._others += 1

    def _refuse(self, why: MessageError) -> None:
        with self._changed:
            self._refused = why
            self._changed.notify_all()

    def _error(self, text: str) -> ForeignError:
        others = f"; {self._others} scans had another stamp: late, or not the image's" if self._others else ""
        return ForeignError(f"{self.command}: {text}{others}")


def at_angles(scan: LaserScan, angles: Floats) -> Beams:
    """What a scan of any grid reports at azimuths [rad]: (beams,) of the nearest beam, NaN beyond the grid."""
    grid = scan.grid()
    first = grid.angle_min - grid.increment / 2
    beam = grid.beam_of(first + (angles - first) % math.tau)
    inside = (beam >= 0) & (beam < grid.beams)
    beam = np.where(inside, beam, 0)
    clear = np.where(inside, scan.clear[beam], np.float32(0.0)) if len(scan.clear) else scan.clear
    ranges = np.where(inside, scan.ranges[beam], np.float32(math.nan))
    return Beams(ranges=ranges, intensities=np.zeros_like(ranges), clear=clear)
