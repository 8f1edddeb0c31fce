"""perception answers as negative, positive and fuse do, for one robot or many, and no robot costs another anything."""

import itertools
import signal

import msgpack
import numpy as np
import pytest
import zenoh

from cliffscan.common.contract.camera import FloorPlane
from cliffscan.services.perception.robot import THEIRS
from tests import scenes
from tests.service.conftest import DEADLINE, image, repeated, scan

SCANS = (
    "scan/positive",
    "scan/negative/near_edge",
    "scan/negative/farthest_point",
    "scan/negative/virtual_floor",
    "scan/negative",
    "scan/fused",
    "scan/safe",
)
THREE = ("negative", "positive", "fuse")
PARTS = (*THREE, "perception")
CAMERA = scenes.camera(160, 120, FloorPlane.from_mount(0.3, 0.2))
HOLE, EMPTY = scenes.depth(CAMERA, [scenes.HOLE]), scenes.depth(CAMERA)
SECOND = 1_000_000_000  # [ns]
PERCEPTION = "services.perception"
FLOOD = 0.002  # [s] between two samples


def perception(start, *options, robots):
    return start("perception", *options, robots=robots, wait=False)


def frame(number, depth=HOLE):
    return image(CAMERA, depth, SECOND + number, seq=number)


def answered(client, ear, number, depth=HOLE):
    """What is answered to a frame."""
    client.put("camera/depth", frame(number, depth))
    return ear.until(lambda answer: answer["stamp"] == SECOND + number)


def settled(status, **counts):
    """The status in which these counts are reached."""
    return status.until(lambda each: all(each["counts"].get(what, 0) >= count for what, count in counts.items()))


LIDAR = ("--set", 'fuse.inputs.lidar={key="scan/lidar", x=0.1}')


@pytest.mark.parametrize("options", [("--set", "profile=paper"), LIDAR], ids=["paper", "default, lidar"])
def test_every_scan_and_count_is_that_of_the_three_services(client, start, options):
    other = client.another()
    for service in THREE:
        start(service, *(options if (service == "fuse") == (options == LIDAR) else ()), wait=False)
    perception(start, *options, robots=[other.robot])
    for part in THREE:
        client.wait_alive(part)
        other.wait_alive(part)
    ears = [{path: each.listen(path) for path in SCANS} for each in (client, other)]
    statuses = [{part: each.listen(f"status/{part}") for part in THREE} for each in (client, other)]
    right, found = ears
    small = scenes.camera(48, 36)
    sent = [frame(number, depth) for number, depth in enumerate([HOLE, EMPTY, HOLE])]
    sent += [image(small, scenes.depth(small), SECOND - 5, seq=0), frame(4)]
    if options == LIDAR:
        for each, of_each in zip((client, other), statuses, strict=True):
            each.put("scan/lidar", scan([0.7, 2.0, np.inf], SECOND))
            settled(of_each["fuse"], received=1)
    for fields in sent:
        for each in (client, other):
            each.put("camera/depth", b"no image")
            each.put("camera/depth", fields)
        for path in SCANS:
            assert found[path].get() == right[path].get(), path
    for part, counts in [("negative", {"malformed": 5}), ("positive", {"malformed": 5}), ("fuse", {"received": 10})]:
        expected, told = (settled(each[part], published=5, **counts) for each in statuses)
        odd = {"stamp_back", "sequence_back"} if part == "fuse" else set()  # of frames, which perception counts once
        assert told["counts"] == {what: count for what, count in expected["counts"].items() if what not in odd}
        assert (told["service"], told["state"], told["note"]) == (part, "working", "")


def test_one_robot_is_served_as_by_any_service(client, start):
    process = start("perception")
    ear, status = client.listen("scan/fused"), client.listen("status/perception")
    assert answered(client, ear, 1)["seq"] == 1
    client.put("camera/depth", b"no image")
    told = settled(status, malformed=1, published=1)
    assert told["counts"] == {"received": 1, "published": 1, "malformed": 1}
    process.wait_said(f"malformed (1 so far): {client.robot}/camera/depth: ")
    process.signal(15)
    assert process.end() == 0
    for part in PARTS:
        client.wait_alive(part, alive=False)


HOSTILE = {
    "malformed": b"no image" * 1000,
    "too large": bytes(5_000_000),
    "good": msgpack.packb(image(scenes.camera(640, 480), scenes.depth(scenes.camera(640, 480)), 1)),
}


@pytest.mark.parametrize("kind", HOSTILE)
@pytest.mark.parametrize("named", [True, False])
def test_a_hostile_robot_costs_no_frame_of_another(client, start, kind, named):
    hostile = client.another()
    perception(start, robots=[client.robot, hostile.robot] if named else ["*"])
    ear = client.listen("scan/fused")
    if named:
        client.wait_alive("perception")
    key = f"{hostile.robot}/camera/depth"
    drop = zenoh.CongestionControl.DROP
    with repeated(lambda: client.session.put(key, HOSTILE[kind], congestion_control=drop), FLOOD):
        first = 0
        while not named and not (client.put("camera/depth", frame(first)) or ear.get_within(0.2)):
            first += 1
        for number in range(first + 1, first + 30):
            answered(client, ear, number)
        assert not ear.all()


def test_every_robot_is_served_from_its_first_frame_on(client, start):
    process = perception(start, robots=["*"])
    process.wait_said("ready for every robot")
    client.wait_subscribed("camera/depth")
    for robot in (client, client.another(), client.another()):
        ear = robot.listen("scan/fused")
        assert answered(robot, ear, 1)["stamp"] == SECOND + 1
        for part in PARTS:
            robot.wait_alive(part)
        assert settled(robot.listen("status/fuse"), published=1)["counts"] == {"received": 2, "published": 1}


def test_a_robot_that_sends_no_image_is_not_discovered(client, start):
    stranger = client.another()
    process = perception(start, robots=["*"])
    process.wait_said("ready for every robot")
    client.wait_subscribed("camera/depth")
    tokens = client.session.liveliness()
    stranger.put("camera/depth", b"no image")
    process.wait_said(f"malformed (1 so far): {stranger.robot}/camera/depth: ")
    answered(client, client.listen("scan/fused"), 1)
    client.wait_alive("perception")
    assert not [reply for reply in tokens.get(f"{stranger.robot}/alive/*", timeout=DEADLINE) if reply.ok]


def test_dump_config_reads_back_to_itself(tmp_path, ask_here):
    first = ask_here(PERCEPTION, "--set", "scan.beams=64", "--set", "fuse.timeout=0.3", "--dump-config")
    assert first.returncode == 0
    file = tmp_path / "config.toml"
    file.write_text(first.stdout)
    assert ask_here(PERCEPTION, "--config", str(file), "--dump-config").stdout == first.stdout
    assert "beams = 64" in first.stdout


@pytest.mark.parametrize(
    ("options", "reason"),
    [
        (["--set", "fuse.timeout=-1"], "perception: fuse.timeout"),
        (["--set", "capture.rate=5"], "perception: --set capture.rate=5: expected TABLE.KEY=VALUE"),
        (["--set", "negativ.range_min=1"], "did you mean negative?"),
        (["--robot", "a*b"], "no robot name"),
    ],
)
def test_a_bad_setting_is_refused_with_one_line(options, reason, ask_here):
    refused = ask_here(PERCEPTION, *options)
    assert refused.returncode == 2
    assert reason in refused.stderr.strip().splitlines()[-1]
    assert "Traceback" not in refused.stderr


def test_a_workstations_scans_are_published_in_time_and_the_robots_own_without_them(client, start):
    workstation = client.another(f"{client.robot}/workstation")
    perception(start, *LIDAR, robots=[client.robot])
    theirs = perception(start, robots=[workstation.robot])
    client.wait_alive("perception")
    workstation.wait_alive("perception")
    ear, status, safe = (client.listen(path) for path in ("scan/fused", "status/perception", "scan/safe"))
    client.put("scan/lidar", scan([0.7, 2.0, np.inf], SECOND))
    stamps, seen = [], []

    def drive(note):
        """Send frames, some twenty a second, until that is the status's note."""
        while not any(each["note"] == note for each in status.all()):
            number = next(numbers)
            client.put("camera/depth", frame(number))
            workstation.put("camera/depth", frame(number))
            answer = ear.get_within(0.05)
            answers = [each for each in [answer, *ear.all()] if each]
            stamps.extend(each["stamp"] for each in answers)
            seen.extend(np.nanmin(np.frombuffer(each["ranges"], "<f4")) for each in answers)

    numbers = itertools.count(1)
    drive(THEIRS)
    theirs.signal(signal.SIGSTOP)
    drive("")
    theirs.signal(signal.SIGCONT)
    drive(THEIRS)
    assert stamps == sorted(set(stamps))
    assert max(seen) < 0.9  # what the robot's own lidar sees is in the scans of the workstation too
    assert set(stamps) - {each["stamp"] for each in safe.all()} <= set(stamps[:1] + stamps[-1:])
