"""record, recover, play and replay-check, through a network and as programs of others see the file."""

import signal
import sys
import time

import msgpack
import numpy as np
import pytest
import zenoh

from cliffscan.common.runtime.raw_samples import RawSample
from cliffscan.recording.parts import Limits, Parts
from cliffscan.recording.reading import Recording
from tests.recordings import SECOND, by_mcap_ros2, by_rosbags, drive, stamps
from tests.service.conftest import DEADLINE, wait_until
from tests.service.test_command import ask

RATE = 15.0  # [Hz]
MATRIX = [0.0] * 9


def cliffscan(*words):
    return [sys.executable, "-m", "cliffscan", *map(str, words)]


@pytest.fixture
def place(client):
    return ["--robot", client.robot, "--mode", "client", "--connect", client.endpoint]


@pytest.fixture
def record(client, run, place):
    """Start a recorder and wait until it receives."""

    def begin(path, *options):
        process = run(cliffscan("record", path, *place, *options))
        process.wait_said(f"recording {client.robot} to")
        client.wait_subscribed("camera/depth")
        return process

    return begin


def put(client, path, payload, schema="DepthImage", attachment=None):
    client.session.put(
        f"{client.robot}/{path}",
        payload,
        encoding=f"application/msgpack;cliffscan.{schema}.v1",
        attachment=attachment,
        congestion_control=zenoh.CongestionControl.BLOCK,
    )


def odometry(stamp):
    return msgpack.packb(
        {
            "stamp": stamp,
            "frame": "odom",
            "child_frame": "base_link",
            "pose": [1.0, 2.0, 0.5],
            "twist": [0.2, 0.0],
            "pose_covariance": MATRIX,
            "twist_covariance": MATRIX,
        }
    )


class Payloads:
    """Every payload on a key, in order."""

    def __init__(self, client, path):
        self.all = []
        self._subscriber = client.session.declare_subscriber(
            f"{client.robot}/{path}", lambda sample: self.all.append(sample.payload.to_bytes())
        )

    def wait(self, holds):
        wait_until(lambda: holds(self.all))


def stamp(payload):
    return msgpack.unpackb(payload)["stamp"]


def test_a_drive_past_stairs_survives_the_recorders_death_bit_by_bit(client, start, record, run, place, tmp_path):
    start("perception")
    path, fixed = tmp_path / "drive.mcap", tmp_path / "fixed.mcap"
    recorder = record(path)
    fused = Payloads(client, "scan/fused")
    sent = []
    for image in drive(45):
        put(client, "camera/depth", image.encode())
        put(client, "base/odom", odometry(image.stamp), "Odometry")
        sent.append((time.monotonic(), image.stamp))
        time.sleep(1.0 / RATE)
    fused.wait(lambda all_of: all_of and stamp(all_of[-1]) == sent[-1][1])
    recorder.expected = -signal.SIGKILL
    recorder.signal(signal.SIGKILL)
    killed = time.monotonic()

    assert recorder.end() == -signal.SIGKILL
    assert ask("recover", path, fixed).returncode == 0
    samples, counts = by_rosbags(fixed)
    others, other_counts = by_mcap_ros2(fixed)
    assert samples == others
    assert counts == other_counts
    assert {"/scan", "/scan_marks", "/scan_clear", "/cliff_points", "/odom", "/tf"} < counts.keys()
    recorded = stamps(samples, "camera/depth")
    assert recorded == [each for _, each in sent][: len(recorded)]
    lost = [each for at, each in sent if at < killed - 2.0 and each not in recorded]  # a second, and a busy machine's
    assert lost == []
    scans = [payload for at, payload in samples if at == "scan/fused"]
    assert_same(scans, fused.all)
    edges = [np.frombuffer(msgpack.unpackb(each)["intensities"], "<f4") for each in scans]
    assert any((each >= 2.0).sum() > 100 for each in edges)  # the stairs

    for file in (path, fixed):  # a broken file is played as well
        fused.all.clear()
        played = run(cliffscan("play", file, "--keys", "scan/fused", *place))
        fused.wait(lambda all_of: all_of and all_of[-1] == scans[-1])
        assert played.end() == 0
        assert_same(fused.all, scans)
    fused.all.clear()
    played = run(cliffscan("play", fixed, "--keys", "camera/depth", *place))  # perception makes the scans anew
    fused.wait(lambda all_of: all_of and all_of[-1] == scans[-1])
    assert played.end() == 0
    assert_same(fused.all, scans)

    checked = ask("replay-check", fixed)
    assert (checked.returncode, checked.stderr) == (0, "")
    assert "100.00 %" in next(line for line in checked.stdout.splitlines() if "scan/fused" in line)


def assert_same(found, expected):
    """Scans of one frame are equal bit by bit; a busy machine drops frames here or there, but not most of them."""
    by_stamp = {stamp(each): each for each in expected}
    common = [each for each in found if stamp(each) in by_stamp]
    assert len(common) > len(expected) // 2
    assert all(by_stamp[stamp(each)] == each for each in common)


def test_a_recording_keeps_every_byte_of_every_key(client, record, place, tmp_path):
    path = tmp_path / "a.mcap"
    recorder = record(path, "--no-ros")
    put(client, "anything/else", b"\x00\xff", "Nothing", attachment=b"attached")
    put(client, "scan/fused", b"no msgpack", "LaserScan")
    deadline = time.monotonic() + DEADLINE
    while len(found := list(Recording(path).samples())) < 2:  # it is read while it is written
        assert time.monotonic() < deadline, recorder.said
    recorder.signal(signal.SIGINT)
    assert recorder.end() == 0
    assert "2 samples" in recorder.said
    assert list(Recording(path).samples()) == found
    assert [(each.path, each.encoding, each.attachment, each.payload) for each in found] == [
        ("anything/else", "application/msgpack;cliffscan.Nothing.v1", b"attached", b"\x00\xff"),
        ("scan/fused", "application/msgpack;cliffscan.LaserScan.v1", b"", b"no msgpack"),
    ]


def test_a_live_base_is_told_no_recorded_scan_and_no_command(client, run, place, tmp_path):
    path = tmp_path / "a.mcap"
    with Parts(path, client.robot, Limits(), None) as parts:
        for number, at in enumerate(
            ("base/cmd_vel", "base/command/stop", "base/cmd_vel_safe", "scan/fused", "description")
        ):
            parts.add(RawSample(at, "application/msgpack", SECOND + number, b"", msgpack.packb({"at": at})))
    everything = Keys(client)
    played = ask("play", path, *place)
    assert played.returncode == 0
    assert (
        "left out commands to a base: 1 of base/cmd_vel, 1 of base/cmd_vel_safe, 1 of base/command/stop"
        in played.stderr
    )
    everything.wait({"scan/fused", "description"})

    token = client.session.liveliness().declare_token(f"{client.robot}/alive/kobuki")
    played = ask("play", path, *place)
    assert played.returncode == 1
    assert f"kobuki of robot {client.robot} would take the recording for what its camera sees now" in played.stderr
    token.undeclare()

    looped = run(cliffscan("play", path, "--loop", "--commands", *place))
    everything.wait({"scan/fused", "description", "base/cmd_vel", "base/command/stop", "base/cmd_vel_safe"})
    deadline = time.monotonic() + DEADLINE
    while kept(client) != [{"at": "description"}]:
        assert time.monotonic() < deadline, looped.said
    looped.signal(signal.SIGINT)
    assert looped.end() == 0


def kept(client):
    """What is kept of the robot's description."""
    replies = client.session.get(f"{client.robot}/description", timeout=DEADLINE)
    return [msgpack.unpackb(each.ok.payload.to_bytes()) for each in replies]


class Keys:
    """The keys on which anything was published, below the robot's name."""

    def __init__(self, client):
        self._found = set()
        self._subscriber = client.session.declare_subscriber(
            f"{client.robot}/**", lambda sample: self._found.add(str(sample.key_expr).removeprefix(f"{client.robot}/"))
        )

    def wait(self, expected):
        wait_until(lambda: self._found == expected)


def test_play_publishes_under_the_recorded_name_unless_another_is_given(client, place, tmp_path):
    path = tmp_path / "a.mcap"
    other = f"{client.robot}-b"
    with Parts(path, other, Limits(), None) as parts:
        parts.add(RawSample("scan/fused", "application/msgpack", SECOND, b"x", b"abc"))
    found = []
    subscriber = client.session.declare_subscriber(
        f"{client.robot}$*/**",
        lambda sample: found.append((str(sample.key_expr), sample.attachment.to_bytes(), sample.payload.to_bytes())),
    )
    assert ask("play", path, *place[2:]).returncode == 0
    assert ask("play", path, *place).returncode == 0
    deadline = time.monotonic() + DEADLINE
    while len(found) < 2:
        assert time.monotonic() < deadline, found
    assert found == [(f"{robot}/scan/fused", b"x", b"abc") for robot in (other, client.robot)]
    subscriber.undeclare()
