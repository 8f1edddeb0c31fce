"""What the doctor makes of a robot that is well, slow, lossy, of another time, version or mount, or half there."""

import time

import msgpack
import pytest

from cliffscan.common.contract.camera import Camera, FloorPlane, Intrinsics
from cliffscan.common.contract.description import CameraDescription, RobotDescription
from cliffscan.common.contract.messages import ServiceStatus
from cliffscan.common.runtime.config import SERVICES
from cliffscan.doctor.finding import Level
from cliffscan.doctor.observation import Observation
from cliffscan.doctor.stream import Arrival, measure
from cliffscan.doctor.verdicts import verdicts

SECOND = 10**9
DATA = bytes(70_000)  # as large as a frame's
BEGIN = 10**18
WELL = {"camera/depth": 30, "scan/positive": 30, "scan/negative": 30, "scan/fused": 30, "base/odom": 50}
RATES = {"kobuki": 50.0}
MOUNT = FloorPlane.from_mount(0.30)


def status(service, ahead=0.0, **changes):
    fields = {"stamp": BEGIN + round(ahead * SECOND), "service": service, "version": "1", "state": "working", "pid": 1}
    fields |= {
        "uptime": 60.0,
        "rate": RATES.get(service, 30.0),
        "latency": (0.0, 0.0),
        "counts": {},
        "note": "",
    }
    return ServiceStatus(**(fields | changes)).encode()


def observed(rates=WELL, services=SERVICES, floor=MOUNT, keep=None, odd=None, odometry_ahead=0.0):
    """Two seconds of a robot. keep: which samples arrive. odd: changes of a service's status."""
    seen = Observation(alive=set(services))
    camera = Camera(640, 480, Intrinsics(575.8, 575.8, 314.5, 235.5), (0.5, 4.5), MOUNT)
    described = CameraDescription.of(camera, "camera", simulated=True)
    seen.take("description", RobotDescription(stamp=1, camera=described).encode(), BEGIN)
    for name in services:
        seen.take(f"status/{name}", status(name, **(odd or {}).get(name, {})), BEGIN + 10**6)
    for path, rate in rates.items():
        for seq in range(2 * rate):
            stamp = BEGIN + seq * SECOND // rate
            fields = {"stamp": stamp, "seq": seq, "floor": list(floor), "period": 1 / 30, "data": DATA}
            if path == "base/odom":
                fields = {"stamp": stamp + round(odometry_ahead * SECOND)}
            if keep is None or keep(path, seq):
                seen.take(path, msgpack.packb(fields), stamp + 2_000_000)
    seen.at = time.monotonic()
    return seen


def found(seen, version="1"):
    """The findings that are not fine, by subject."""
    return {each.subject: each for each in verdicts(seen, version) if each.level is not Level.OK}


def test_a_robot_that_is_well_has_no_finding():
    assert found(observed()) == {}


@pytest.mark.parametrize(
    ("keep", "level"),
    [
        (lambda path, seq: path != "camera/depth" or seq % 30, Level.WARNING),
        (lambda path, seq: path != "camera/depth" or seq % 3, Level.FAULT),
    ],
)
def test_a_link_that_loses_frames_is_told(keep, level):
    told = found(observed(keep=keep))
    assert {name: each.level for name, each in told.items()} == {"camera/depth": level}
    assert "give `--perception` to the robot" in told["camera/depth"].text


def test_a_slow_writer_is_told_from_a_thin_link():
    told = found(observed(WELL | {"base/odom": 40, "scan/fused": 10}, odd={"kobuki": {"rate": 40.0}}))
    assert {name: each.level for name, each in told.items()} == {
        "base/odom": Level.WARNING,
        "scan/fused": Level.FAULT,
    }
    assert all("what publishes it is slow" in each.text for each in told.values())
    thin = found(observed(WELL | {"base/odom": 40}))["base/odom"]
    assert thin.level is Level.WARNING
    assert "the link is too thin" in thin.text


def test_frames_of_which_none_arrives_are_told():
    rates = {path: rate for path, rate in WELL.items() if path != "camera/depth"}
    told = found(observed(rates))["camera/depth"]
    assert told.level is Level.FAULT
    assert told.text.startswith("nothing arrives, though 30.0 Hz are published")


@pytest.mark.parametrize(("ahead", "level"), [(0.2, Level.WARNING), (-0.2, Level.WARNING), (10.0, Level.FAULT)])
def test_a_clock_that_is_off_is_told(ahead, level):
    told = found(observed(services=["capture"], rates={}, odd={"capture": {"ahead": ahead}}))["clock of capture"]
    assert told.level is level
    assert "synchronise both hosts (chrony" in told.text
    assert ("ahead of" if ahead > 0 else "behind") in told.text


def test_odometry_shows_the_base_s_clock_where_its_status_was_late():
    assert "clock of kobuki" in found(observed(odd={"kobuki": {"ahead": -1.0}}, odometry_ahead=-0.3))
    assert "clock of kobuki" not in found(observed(odd={"kobuki": {"ahead": -1.0}}))


def test_another_version_is_told():
    told = found(observed(odd={"fuse": {"version": "0.9"}}))
    assert told["versions"].text == "1 here, and fuse 0.9: install the same on both hosts"


@pytest.mark.parametrize(
    ("mount", "level"),
    [((0.30, 0.005), None), ((0.33,), Level.WARNING), ((0.30, 0.03), Level.WARNING), ((0.30, 0.0, 0.09), Level.FAULT)],
)
def test_a_mount_that_the_floor_contradicts_is_told(mount, level):
    told = found(observed(floor=FloorPlane.from_mount(*mount)))
    assert {name: each.level for name, each in told.items()} == ({"mount": level} if level else {})


def test_half_of_the_services_are_told_from_the_rest():
    told = found(observed(rates={"camera/depth": 30}, services=["capture", "negative"]))
    levels = {name: each.level for name, each in told.items()}
    expected = dict.fromkeys(("fuse", "positive", "scan/negative"), Level.FAULT) | {"kobuki": Level.WARNING}
    assert levels == expected
    assert "cliffscan run fuse" in told["fuse"].text


def test_a_service_that_waits_for_its_device_is_told_with_its_note():
    odd = {"kobuki": {"state": "waiting", "note": "/dev/kobuki: No such file"}}
    told = found(observed(odd=odd))["kobuki"]
    assert told.level is Level.FAULT
    assert told.text.endswith("/dev/kobuki: No such file")


@pytest.mark.parametrize(
    "payload", [b"", b"\xff", msgpack.packb([]), msgpack.packb({"stamp": "x"}), msgpack.packb({"stamp": 1})]
)
def test_malformed_samples_are_told_and_nothing_else_happens(payload):
    seen = observed()
    seen.take("camera/depth", payload, BEGIN)
    assert set(found(seen)) == {"camera/depth"}


@pytest.mark.parametrize("stamp", [2**64 - 1, 2**63, -1, 1.5, "1"])
def test_a_stamp_that_is_none_is_malformed(stamp):
    seen = observed()
    for seq in range(3):
        seen.take("scan/fused", msgpack.packb({"stamp": stamp, "seq": seq}), BEGIN)
    assert seen.malformed == {"scan/fused"}
    assert set(found(seen)) == {"scan/fused"}


def test_the_highest_numbers_are_measured():
    arrivals = [Arrival(2**64 - 4 + n, 2**63 - 1, n * SECOND, 100) for n in (0, 1, 3)]
    assert measure(arrivals).lost == 1 / 3


def test_a_stream_is_measured_across_a_restart_of_its_writer():
    seqs = [7, 8, 10, 0, 1, 2]
    arrivals = [Arrival(seq, n * SECOND, n * SECOND + 5, 100) for n, seq in enumerate(seqs)]
    stream = measure(arrivals)
    assert (stream.rate, stream.bytes_per_second, stream.lost) == (1.0, 100.0, 1 / 5)
    assert measure(arrivals[:1]).rate == 0.0
