"""Every service with the keys of its role, over two routers: what it makes arrives on the other side."""

import contextlib
import itertools
import sys
import time
from datetime import timedelta

import msgpack
import numpy as np
import pytest

from cliffscan.common.contract.camera import FloorPlane
from cliffscan.run import service_names
from cliffscan.secure.folder import KeyFolder
from cliffscan.services.perception.robot import THEIRS
from tests import scenes
from tests.build import odometry_fields
from tests.ros2_peer import ROS, Peer
from tests.service.conftest import Ear, image, repeated, scan
from tests.service.test_capture_ros2 import LEVEL, OPTICAL, TF, Driver, transform
from tests.service.test_secure_door import opened, secured_endpoint

CAMERA = scenes.camera(160, 120, FloorPlane.from_mount(0.3, 0.2))
HOLE = scenes.depth(CAMERA, [scenes.HOLE])
TWIST = "geometry_msgs/msg/Twist"
PERIOD = 0.05  # [s] of what is published over and over
ROBOT, WORKSTATION = "robot", "workstation"
PLACES = dict.fromkeys(("capture", "kobuki", "gate"), ROBOT) | dict.fromkeys(
    ("negative", "positive", "fuse", "perception", "ros2"), WORKSTATION
)
REFUSALS = ("may not", "shows itself to no", "passes nothing")


class Hosts:
    """Two routers with keys, and sessions of roles on either."""

    def __init__(self, folder) -> None:
        self.keys = folder / "keys"
        KeyFolder(self.keys).init("r", [])
        self.ends = {ROBOT: secured_endpoint(), WORKSTATION: secured_endpoint()}
        near, far = self.ends.values()
        self._open = [opened(self.keys, "router", listen=near)]
        self._open.append(opened(self.keys, "router-workstation", listen=far, connect=near))
        self._tokens = [
            session.liveliness().declare_token(f"r/alive/router-{name}")
            for session, name in zip(self._open, self.ends, strict=True)
        ]

    def session(self, role, place):
        self._open.append(opened(self.keys, role, connect=self.ends[place]))
        return self._open[-1]

    def hear(self, path, place, role="recorder"):
        return Ear(self.session(role, place), f"r/{path}")

    def publish(self, path, role, place, make):
        """Publish what `make` makes on a path of the robot, with the keys of a role."""
        session = self.session(role, place)
        return lambda: session.put(f"r/{path}", msgpack.packb(make()))

    def command(self, service, *options, robot="r"):
        where = ["--robot", robot, "--secure", str(self.keys), "--connect", self.ends[PLACES[service]]]
        return [sys.executable, "-m", f"services.{service}", *where, *map(str, options)]

    def close(self):
        for session in reversed(self._open):
            session.close()


@pytest.fixture
def hosts(tmp_path):
    made = Hosts(tmp_path)
    yield made
    made.close()


def frames():
    """A maker of depth images, and of scans of the same seq and stamp."""
    numbers = itertools.count(1)
    return lambda: image(CAMERA, HOLE, time.time_ns(), seq=next(numbers))


def fused():
    return scan(np.full(20, 2.0), time.time_ns())


def ahead():
    return {"stamp": time.time_ns(), "linear": 0.1, "angular": 0.0}


def well(process):
    """It said nothing of a door that is closed to it."""
    assert not any(each in process.said for each in REFUSALS), process.said


def test_every_service_is_tried_here():
    assert set(PLACES) == set(service_names())


@pytest.mark.parametrize(
    ("service", "path"),
    [("negative", "scan/negative"), ("positive", "scan/positive"), ("perception", "scan/fused")],
)
def test_scans_of_the_robots_frames_come_back_to_it(hosts, run, service, path):
    process = run(hosts.command(service))
    process.wait_said("ready")
    arrived, status = hosts.hear(path, ROBOT, "viewer"), hosts.hear(f"status/{service}", ROBOT, "viewer")
    with repeated(hosts.publish("camera/depth", "capture", ROBOT, frames()), PERIOD):
        arrived.get()
        status.until(lambda told: told["state"] == "working")
    well(process)


def test_the_workstations_fuse_answers_with_scans_of_there_and_says_when_its_keys_end(hosts, run):
    KeyFolder(hosts.keys).issue("fuse", timedelta(days=5, hours=1))
    process = run(hosts.command("fuse"))
    arrived, status = hosts.hear("scan/fused", ROBOT, "kobuki"), hosts.hear("status/fuse", ROBOT)
    stamps = itertools.count(1)
    senders = [(hosts.session(role, WORKSTATION), f"r/scan/{role}") for role in ("negative", "positive")]

    def both():
        message = msgpack.packb(scan([1.0, 2.0], next(stamps)))
        for session, key in senders:
            session.put(key, message)

    with repeated(both, PERIOD):
        arrived.get()
        status.until(lambda told: "its certificate expires in 5 days" in told["note"])
    well(process)


def test_frames_of_the_camera_come_to_the_workstation(hosts, run):
    process = run(hosts.command("capture", "--set", "capture.source=simulator", "--set", "capture.world=landing"))
    hosts.hear("camera/depth", WORKSTATION, "negative").get()
    hosts.hear("status/capture", WORKSTATION).get()
    well(process)


def test_the_base_is_driven_from_the_workstation(hosts, run, tmp_path):
    link = tmp_path / "kobuki"
    run([sys.executable, "-m", "simulator.kobuki", "--link", str(link)]).wait_said("ready")
    options = ("--set", f"kobuki.port={link}", "--set", "kobuki.require_scan=false")
    process = run(hosts.command("kobuki", *options))
    odometry, safety = (hosts.hear(f"base/{name}", WORKSTATION, "driver") for name in ("odom", "safety"))
    with repeated(hosts.publish("base/cmd_vel", "driver", WORKSTATION, ahead), PERIOD):
        odometry.until(lambda told: told["twist"][0] > 0.0)
        safety.get()
    well(process)


def test_a_base_of_another_make_is_driven_from_the_workstation_through_the_gate(hosts, run):
    process = run(hosts.command("gate", "--set", "gate.simulated=true"))
    safe, safety = hosts.hear("base/cmd_vel_safe", ROBOT, "base"), hosts.hear("base/safety", WORKSTATION, "driver")

    def odometry():
        return odometry_fields(stamp=time.time_ns(), twist=[0.0, 0.0], pose=[0.0, 0.0, 0.0])

    with (
        repeated(hosts.publish("base/odom", "base", ROBOT, odometry), 0.02),
        repeated(hosts.publish("scan/fused", "fuse", WORKSTATION, fused), PERIOD),
        repeated(hosts.publish("base/cmd_vel", "driver", WORKSTATION, ahead), PERIOD),
    ):
        safe.get()
        safety.get()
    well(process)


def of_a_node(hosts):
    """The Zenoh file of a ROS node, and its domain."""
    return hosts.keys / "ros2-nodes/zenoh.json5", 0


@pytest.fixture
def node(hosts):
    """A ROS node on the robot."""
    made = Peer(hosts.ends[ROBOT], *of_a_node(hosts))
    yield made
    made.close()


def test_ros_nodes_of_the_robot_are_served_from_the_workstation(hosts, run, node):
    process = run(hosts.command("ros2"))
    tokens = node.tokens_when(lambda all_of: any(token[5] == "NN" for token in all_of))
    assert any(token[5] == "SS" for token in tokens)
    scans = node.subscribe("scan", "sensor_msgs/msg/LaserScan")
    velocities, map_ = hosts.hear("base/cmd_vel", ROBOT, "kobuki"), hosts.publish("map", "slam", WORKSTATION, grid)
    vector = ROS.types["geometry_msgs/msg/Vector3"]
    twist = ROS.types[TWIST](vector(0.2, 0.0, 0.0), vector(0.0, 0.0, 0.1))
    with (
        repeated(hosts.publish("scan/fused", "fuse", WORKSTATION, fused), PERIOD),
        repeated(lambda: node.publish("cmd_vel", TWIST, twist), PERIOD),
    ):
        scans.get()
        assert velocities.get()["source"] == "ros2"
    map_()
    late = node.subscribe("map", "nav_msgs/msg/OccupancyGrid", latched=True)
    assert late.get().info.width == 2
    well(process)


def grid():
    fields = {"stamp": time.time_ns(), "frame": "map", "resolution": 0.05, "width": 2, "height": 1}
    return fields | {"origin": [0.0, 0.0, 0.0], "data": bytes(2)}


def test_a_domain_for_which_there_are_no_rules_is_said(hosts, run):
    process = run(hosts.command("ros2", "--set", "ros2.domain=5"))
    process.wait_said("ROS domain 5: a secured router passes nothing of it, these keys are for 0: make keys by")


def test_a_camera_that_ros_drives_is_received_with_its_mount_which_was_published_before(hosts, run):
    with contextlib.closing(Driver(hosts.ends[ROBOT], *of_a_node(hosts))) as driver:
        driver.latch("tf_static", TF, ROS.types[TF]([transform("base_footprint", OPTICAL, (0.12, 0.03, 0.45), LEVEL)]))
        driver.begin()
        depth, described = (hosts.hear(path, WORKSTATION) for path in ("camera/depth", "description"))
        process = run(hosts.command("capture", "--set", "capture.source=ros2", "--set", "capture.height=0.3"))
        depth.get()
        assert described.get()["camera"]["height"] == pytest.approx(0.45)
        well(process)


def test_a_workstation_perceives_for_a_robot_that_does_so_too(hosts, run):
    of_robot = hosts.command("perception")
    of_robot[of_robot.index(hosts.ends[WORKSTATION])] = hosts.ends[ROBOT]
    processes = [run(of_robot), run(hosts.command("perception", robot="r/workstation"))]
    for process in processes:
        process.wait_said("ready")
    status, capture = hosts.hear("status/perception", WORKSTATION), hosts.session("capture", ROBOT)
    theirs = hosts.hear("workstation/status/perception", ROBOT)
    make = frames()

    def both():
        payload = msgpack.packb(make())
        for key in ("r/camera/depth", "r/workstation/camera/depth"):
            capture.put(key, payload)

    with repeated(both, PERIOD):
        status.until(lambda told: told["note"] == THEIRS)
        theirs.until(lambda told: told["state"] == "working")
    for process in processes:
        well(process)
