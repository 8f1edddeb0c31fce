"""What the unit tests are made of: messages as a foreign client builds them, depth folders, and a bus of lists."""

import json
import math
import threading
from collections import defaultdict
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace

import msgpack
import numpy as np
from PIL import Image

from cliffscan.common.contract.beam_fields import BEAM_FIELDS
from cliffscan.common.contract.camera import Camera, FloorPlane, Intrinsics
from cliffscan.common.contract.messages import LaserScan
from cliffscan.common.runtime.latest_queue import LatestQueue
from cliffscan.common.runtime.service import Service

GONE = object()  # for a field that is left out
SECOND = 1_000_000_000  # [ns]


def depth_fields(**changes) -> dict:
    """A DepthImage of 3 x 2 pixels, as the contract has it, in plain types."""
    fields = {
        "seq": 7,
        "stamp": 5 * SECOND,
        "period": 0.1,
        "frame": "camera",
        "width": 3,
        "height": 2,
        "encoding": "16UC1",
        "data": np.array([[0, 500, 1000], [1500, 2000, 65535]], "<u2").tobytes(),
        "intrinsics": [3.0, 2.5, 1.0, 0.5],
        "range": [0.5, 4.5],
        "floor": [0.0, -1.0, 0.0, 0.3],
        "noise": 0.002,
        "baseline": 0.05,
        "region": [0, 0, 2, 1],
    }
    return _changed(fields, changes)


def scan_fields(**changes) -> dict:
    """A LaserScan of three beams, in plain types."""
    fields = {
        "seq": 7,
        "stamp": 5 * SECOND,
        "frame": "camera_footprint",
        "angle_min": -0.5,
        "angle_max": 0.5,
        "angle_increment": 0.5,
        "time_increment": 0.0,
        "scan_time": 0.033,
        "range_min": 0.0,
        "range_max": 4.5,
        **dict.fromkeys(BEAM_FIELDS, b""),
        "ranges": np.array([1.0, math.inf, math.nan], "<f4").tobytes(),
        "intensities": np.array([2.0, 0.0, 0.0], "<f4").tobytes(),
        "clear": np.array([0.9, 3.5, 0.7], "<f4").tobytes(),
    }
    return _changed(fields, changes)


def odometry_fields(**changes) -> dict:
    """An Odometry of a robot that drives ahead, in plain types."""
    fields = {
        "stamp": 5 * SECOND,
        "frame": "odom",
        "child_frame": "base_link",
        "pose": [1.0, 2.0, 0.5],
        "twist": [0.2, 0.0],
        "pose_covariance": [0.0] * 9,
        "twist_covariance": [0.0] * 9,
    }
    return _changed(fields, changes)


def status_fields(**changes) -> dict:
    """A ServiceStatus, in plain types."""
    fields = {
        "stamp": 5 * SECOND,
        "service": "fuse",
        "version": "0.1.0",
        "state": "working",
        "pid": 4711,
        "uptime": 12.5,
        "rate": 30.0,
        "latency": [0.004, 0.009],
        "counts": {"received": 12},
        "note": "",
    }
    return _changed(fields, changes)


def _changed(fields: dict, changes: dict) -> dict:
    return {key: value for key, value in (fields | changes).items() if value is not GONE}


def payload(fields: dict) -> bytes:
    """The bytes that a client with nothing but msgpack sends."""
    return msgpack.packb(fields)


def scan(ranges, intensities=(), clear=(), angle_min=-0.5, increment=None, range_max=10.0, **changes) -> LaserScan:
    """A scan with these ranges; by default its beams end at +0.5 rad."""
    step = increment or (-2 * angle_min / (len(ranges) - 1) if len(ranges) > 1 else 1.0)
    fields = scan_fields(
        angle_min=angle_min,
        angle_increment=step,
        angle_max=angle_min + (len(ranges) - 1) * step,
        range_max=range_max,
        ranges=np.array(ranges, "<f4").tobytes(),
        intensities=np.array(intensities, "<f4").tobytes(),
        clear=np.array(clear, "<f4").tobytes(),
        **changes,
    )
    return LaserScan.decode(payload(fields))


def camera(width=64, height=48, focal=58.0, mount=(0.3, 0.0, 0.0), reach=(0.5, 4.5), centre=None) -> Camera:
    """A camera `mount`ed at a height [m], pitch and roll [rad], its principal point by default on a pixel."""
    cx, cy = centre or (width // 2, height // 2)
    return Camera(width, height, Intrinsics(focal, focal, cx, cy), reach, FloorPlane.from_mount(*mount))


CAMERA_FILE = {
    "width": 4,
    "height": 3,
    "intrinsics": [4.0, 4.0, 1.5, 1.0],
    "range": [0.5, 4.5],
    "floor": [0.0, -1.0, 0.0, 0.3],
}


def depth_folder(folder: Path, count=3, **camera_file) -> Path:
    """A depth folder of `count` frames 000, 001 …; frame k holds depth 1000 + k mm everywhere."""
    (folder / "camera.json").write_text(json.dumps(_changed(CAMERA_FILE, camera_file)))
    for number in range(count):
        write_png(folder / f"{number:03}.png", np.full((3, 4), 1000 + number, np.uint16))
    return folder


def write_png(path: Path, pixels: np.ndarray) -> Path:
    Image.fromarray(pixels).save(path)
    return path


class Stop(threading.Event):
    """Whether a service shall end; waiting takes no time, and is written down."""

    def __init__(self) -> None:
        super().__init__()
        self.patient = True
        self.waits: list[float] = []

    def wait(self, timeout=None) -> bool:
        self.waits.append(timeout)
        return self.is_set()


class Bus:
    """The bus of a service that runs alone: `said` is what it published, by path; `arrive` is the network."""

    robot = "turtlebot"

    def __init__(self) -> None:
        self.said: dict[str, list] = defaultdict(list)
        self.announced: list[str] = []
        self.withdrawn = 0
        self.receivers: dict[str, Callable[[str, bytes], object]] = {}
        self.on_announce = lambda: None
        self.watchers: dict[str, Callable[[str, bool], None]] = {}

    def beside(self, robot):
        return SimpleNamespace(watch_alive=lambda changed: self.watchers.update({robot: changed}))

    def publisher(self, topic):
        return SimpleNamespace(put=self.said[topic.path].append, has_subscribers=True)

    def subscribe(self, path, receive, *_limits) -> None:
        self.receivers[path] = receive

    def receive_latched(self, path, receive) -> None:
        self.subscribe(path, receive)

    def latch(self, topic):
        return self.said[topic.path].append

    def announce(self, service) -> None:
        self.announced.append(service)
        self.on_announce()

    def withdraw(self) -> None:
        self.withdrawn += 1

    def notice(self) -> str:
        return ""

    def arrive(self, path, data: bytes) -> None:
        self.receivers[path](path, data)


def service(name: str, config) -> Service:
    """A service on a Bus of its own, ended by `.stop.set()`."""
    stop = Stop()
    made = Service(name, config, Bus(), stop)
    made.stop = stop
    return made


def play(serve, name: str, config, samples, monkeypatch, queue_of="cliffscan.common.runtime.service") -> Service:
    """Run a service until it has worked off samples [(path, bytes)], which all arrive as soon as it is ready."""
    made = service(name, config)

    class Patient(LatestQueue):
        """Holds all that comes; the service ends when there is no more."""

        def __init__(self, _room=1) -> None:
            super().__init__(1000)

        def get(self, _timeout):
            item = super().get(0.0)
            if item is None:
                made.stop.set()
            return item

    def all_arrive() -> None:
        for path, data in samples:
            made.bus.arrive(path, data)

    monkeypatch.setattr(f"{queue_of}.LatestQueue", Patient)
    made.bus.on_announce = all_arrive
    serve(made)
    return made
