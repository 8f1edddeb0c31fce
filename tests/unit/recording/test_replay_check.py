"""Recorded frames through today's services: three drives as they were, and what a check notices."""

from pathlib import Path

import numpy as np
import pytest

from cliffscan.common.contract.messages import LaserScan
from cliffscan.common.perception.known_ground import safe_scan
from cliffscan.common.runtime.raw_samples import RawSample
from cliffscan.recording.errors import RecordingError
from cliffscan.recording.parts import Limits as Size
from cliffscan.recording.parts import Parts
from cliffscan.recording.reading import Recording
from cliffscan.recording.replay_check import Limits, ReplayCheck, replay_check
from cliffscan.services.perception.perceive import Settings, perceive
from cliffscan.services.positive.config import PositiveConfig
from tests.build import payload
from tests.recordings import drive

RECORDINGS = sorted((Path(__file__).parents[2] / "data/recordings").glob("*.mcap"))
LIMITS = Limits(tolerance=0.01, share=0.001)
AS_IT_IS = (None, ())
IMAGE = next(drive(1))


def test_there_are_three_small_recordings():
    assert len(RECORDINGS) == 3
    assert all(path.stat().st_size < 400_000 for path in RECORDINGS)


@pytest.mark.parametrize("path", RECORDINGS, ids=lambda path: path.stem)
def test_the_scans_of_a_drive_are_what_they_were(path, tmp_path, capsys):
    picture = tmp_path / f"{path.stem}.png"
    assert replay_check(path, AS_IT_IS, LIMITS, picture, None) == 0, capsys.readouterr()
    assert picture.read_bytes().startswith(b"\x89PNG")


def test_other_settings_are_noticed_drawn_and_may_be_accepted(tmp_path, capsys):
    changed, picture, renewed = (None, ["negative.floor_lost=ignored"]), tmp_path / "worst.png", tmp_path / "new.mcap"
    path = next(path for path in RECORDINGS if path.stem == "landing")
    assert replay_check(path, changed, LIMITS, picture, renewed) == 1
    said = capsys.readouterr()
    assert "of its beams by more than 0.01 m or in kind, expected 0.1 % at most" in said.err
    assert f"the scan that differs most is drawn in {picture}" in said.err
    assert picture.exists()
    assert replay_check(renewed, changed, LIMITS, tmp_path / "b.png", None) == 0
    assert replay_check(renewed, AS_IT_IS, LIMITS, tmp_path / "c.png", None) == 1
    before, after = (list(Recording(each).samples()) for each in (path, renewed))
    assert [each._replace(payload=b"") for each in after] == [each._replace(payload=b"") for each in before]


def sample(path, message):
    data = message if isinstance(message, bytes) else message.encode()
    return RawSample(path, "application/msgpack", 5, b"", data)


def frame():
    return sample("camera/depth", IMAGE)


def fused(settings=None, **changes):
    scan = perceive(IMAGE, settings or Settings()).fused
    return sample("scan/fused", scan.model_copy(update=changes))


def test_the_scan_that_is_safe_to_read_alone_is_compared_too():
    safe = safe_scan(perceive(IMAGE, Settings()).fused)
    check = checked(frame(), sample("scan/safe", safe))
    assert (check.tallies["scan/safe"].scans, check.worst.share) == (1, 0.0)


def moved(beams, by):
    ranges = perceive(IMAGE, Settings()).fused.ranges.copy()
    hit = np.flatnonzero(np.isfinite(ranges))[:beams]
    ranges[hit] += np.float32(by)
    return fused(ranges=ranges)


def checked(*samples, settings=None, limits=LIMITS):
    check = ReplayCheck(settings or Settings(), limits)
    for each in samples:
        check.take(each)
    check.finish()
    return check


@pytest.mark.parametrize(("beams", "by"), [(0, 0.0), (1, 0.02), (30, 0.02), (30, 0.005)])
def test_beams_that_moved_are_counted(beams, by):
    check = checked(frame(), moved(beams, by))
    assert check.worst.share == pytest.approx(beams / 640 if by > 0.01 else 0.0)


@pytest.mark.parametrize("order", [1, -1])
def test_a_scan_may_come_before_its_frame(order):
    check = checked(*[frame(), fused()][::order])
    assert (check.tallies["scan/fused"].scans, check.alone) == (1, 0)


def test_a_scan_without_its_frame_is_told():
    check = checked(frame(), fused(), fused(stamp=1))
    assert (check.tallies["scan/fused"].scans, check.alone) == (1, 1)


def test_the_described_body_counts_unless_the_settings_give_one():
    low = PositiveConfig(robot_height=0.05)
    body = {"stamp": 1, "body": {"simulated": True, "radius": 0.18, "height": 0.05}}
    described = sample("description", payload(body))
    seen_low = fused(Settings(positive=low))
    assert checked(described, frame(), seen_low).worst.share == 0.0
    assert checked(frame(), seen_low).worst.share > 0.0
    given = Settings(positive=PositiveConfig(robot_height=0.42))
    assert checked(described, frame(), seen_low, settings=given).worst.share > 0.0


def test_other_beams_are_refused_with_a_remedy():
    scan = LaserScan.decode(fused().payload)
    half = {name: values[:320] for name, values in scan.arrays().items()}
    other = fused(**half, angle_max=scan.angle_min + 319 * scan.angle_increment)
    with pytest.raises(
        RecordingError, match=r"scan/fused was recorded with .*: give the robot's settings with --config"
    ):
        checked(frame(), other)


def test_what_is_malformed_is_counted_and_the_rest_is_left_alone():
    check = checked(sample("camera/depth", b"no"), sample("base/odom", b"no"), frame(), fused())
    assert (check.malformed, check.frames, check.worst.share) == (1, 1, 0.0)


def test_a_recording_of_frames_alone_is_refused(tmp_path):
    with Parts(tmp_path / "a.mcap", "turtlebot", Size(), None) as parts:
        parts.add(frame())
    with pytest.raises(RecordingError, match="holds 1 depth images and no scan of them"):
        replay_check(tmp_path / "a.mcap", AS_IT_IS, LIMITS, None, None)
