"""A depth folder is played in order of name, at its rate, with its own camera; or refused when it cannot be."""

import json
from types import SimpleNamespace

import numpy as np
import pytest

from cliffscan.common.runtime.config import ConfigError
from cliffscan.services.capture.config import CaptureConfig
from cliffscan.services.capture.sources import replay
from cliffscan.services.capture.sources.depth_folder import DepthFolder
from cliffscan.services.capture.sources.depth_source import BadFrame, SourceEnded
from cliffscan.services.capture.sources.open_source import open_source
from tests import build
from tests.build import GONE, SECOND, depth_folder

NOW = 1_700_000_000 * SECOND


@pytest.fixture
def clock(monkeypatch):
    """Stands in for the module `time`: sleeping passes the time, and is written down."""
    clock = SimpleNamespace(now=50.0, slept=[])

    def sleep(seconds):
        clock.slept.append(seconds)
        clock.now += seconds

    clock.sleep, clock.monotonic = sleep, lambda: clock.now
    clock.time_ns = lambda: NOW + round((clock.now - 50.0) * SECOND)
    monkeypatch.setattr(replay, "time", clock)
    return clock


@pytest.fixture
def folder(tmp_path, clock):
    return depth_folder(tmp_path)


def played(folder, rate, loop):
    return replay.Replay(DepthFolder(folder), rate, loop)


def frames_of(source, count):
    """The next frames; a source is asked again where none is due yet."""
    frames = []
    for _ in range(100 * count):
        frame = source.read(timeout=0.1)
        frames += [frame] if frame else []
        if len(frames) == count:
            return frames
    raise AssertionError(f"only {len(frames)} of {count} frames came")


def millimetres(frames):
    return [int(frame.depth[0, 0]) for frame in frames]


def test_frames_are_played_in_order_of_name(folder):
    build.write_png(folder / "0005.png", np.full((3, 4), 7, np.uint16))
    assert millimetres(frames_of(played(folder, 30, loop=False), 4)) == [1000, 7, 1001, 1002]


def test_a_name_in_capitals_is_a_pngs_too(folder):
    (folder / "001.png").rename(folder / "001.PNG")
    (folder / "notes.txt").write_text("001 is blurred")
    assert millimetres(frames_of(played(folder, 30, loop=False), 3)) == [1000, 1001, 1002]


def test_a_frame_has_its_pixels_and_its_camera(folder):
    pixels = np.arange(12, dtype=np.uint16).reshape(3, 4) * 5000
    build.write_png(folder / "000.png", pixels)
    (frame,) = frames_of(played(folder, 30, loop=False), 1)
    np.testing.assert_array_equal(frame.depth, pixels)
    assert frame.depth.dtype == np.uint16
    assert (frame.camera.width, frame.camera.height, frame.camera.range) == (4, 3, (0.5, 4.5))
    assert frame.camera.intrinsics == (4.0, 4.0, 1.5, 1.0)
    assert frame.camera.floor == (0.0, -1.0, 0.0, 0.3)


def test_once_is_once(folder):
    source = played(folder, 30, loop=False)
    frames_of(source, 3)
    for _ in range(2):
        with pytest.raises(SourceEnded):
            source.read(0.1)
    source.close()


def test_a_loop_goes_on(folder):
    assert millimetres(frames_of(played(folder, 30, loop=True), 7)) == [1000, 1001, 1002, 1000, 1001, 1002, 1000]


def test_frames_come_at_their_rate_without_drift(folder, clock):
    stamps = []
    source = played(folder, 8.0, loop=True)
    for _ in range(16):
        stamps += [frame.stamp for frame in frames_of(source, 1)]
        clock.now += 0.01  # the work on a frame
    np.testing.assert_allclose(np.diff(stamps) / SECOND, 0.125)
    assert stamps[0] == NOW
    assert max(clock.slept) <= 0.1


def test_no_wait_is_longer_than_the_timeout(folder, clock):
    source = played(folder, 1.0, loop=True)
    assert source.read(0.1)
    assert [source.read(0.25) for _ in range(3)] == [None] * 3
    assert source.read(0.25) is not None
    assert clock.slept[1:] == [0.25] * 4


def test_a_long_delay_is_not_made_up_for(folder, clock):
    source = played(folder, 10.0, loop=True)
    frames_of(source, 1)
    clock.now += 5.0
    _, second, third = frames_of(source, 3)
    assert second.stamp - NOW < 5.2 * SECOND
    assert third.stamp - second.stamp == pytest.approx(0.1 * SECOND, abs=2)


def test_a_frames_own_values_override_the_folders(tmp_path, clock):
    own = {"stamp": 5, "intrinsics": [5, 6, 1, 2], "floor": [0, -0.6, -0.8, 0.5]}
    frames = {"000": {"stamp": 4}, "001": own}
    first, second = frames_of(played(depth_folder(tmp_path, 2, frames=frames), 30, loop=False), 2)
    assert (second.stamp, second.camera.intrinsics, second.camera.floor) == (5, (5, 6, 1, 2), (0, -0.6, -0.8, 0.5))
    assert first.camera.floor == (0, -1, 0, 0.3)
    assert first.stamp == 4


def test_some_stamps_are_refused_for_recorded_and_present_times_do_not_mix(tmp_path):
    folder = depth_folder(tmp_path, frames={"000": {"stamp": 5}, "002": {"stamp": 6}})
    reason = r"camera\.json: 1 of 3 frames have no stamp, 001\.png first: give each frame one, or none"
    with pytest.raises(ConfigError, match=reason):
        played(folder, 30, loop=False)


def test_two_frames_of_one_stamp_are_refused_with_the_remedy(tmp_path):
    frames = {name: {"stamp": stamp} for name, stamp in (("000", 5), ("001", 6), ("002", 5))}
    folder = depth_folder(tmp_path, frames=frames)
    reason = r"camera\.json: 000\.png and 002\.png have the same stamp, 5: give each frame its own, or none any"
    with pytest.raises(ConfigError, match=reason):
        played(folder, 30, loop=False)


def test_two_images_of_one_name_have_one_stamp_and_are_refused(tmp_path):
    frames = {f"{number:03}": {"stamp": number} for number in range(3)}
    folder = depth_folder(tmp_path, frames=frames)
    build.write_png(folder / "001.PNG", np.full((3, 4), 7, np.uint16))
    with pytest.raises(ConfigError, match=r"001\.PNG and 001\.png have the same stamp, 1"):
        played(folder, 30, loop=False)


def test_the_period_is_that_of_the_recorded_stamps(tmp_path, clock):
    frames = {f"{n:03}": {"stamp": 7000 + n * SECOND // 5} for n in range(3)}
    source = played(depth_folder(tmp_path, 3, frames=frames), 30, loop=False)
    assert [frame.period for frame in frames_of(source, 3)] == [pytest.approx(0.2)] * 3


def test_without_stamps_the_period_is_that_of_the_rate(folder):
    assert [frame.period for frame in frames_of(played(folder, 10, loop=False), 2)] == [None, None]


def test_stamps_go_on_from_round_to_round(tmp_path, clock):
    frames = {f"{n:03}": {"stamp": 7000 + n * SECOND // 10} for n in range(3)}
    source = played(depth_folder(tmp_path, 3, frames=frames), 10, loop=True)
    stamps = [frame.stamp for frame in frames_of(source, 9)]
    assert stamps[:3] == [7000, 7000 + SECOND // 10, 7000 + SECOND // 5]
    np.testing.assert_array_equal(np.diff(stamps), SECOND // 10)


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        ({"width": GONE}, "width: Field required"),
        ({"range": GONE}, "range: Field required"),
        ({"intrinsics": [1, 2, 3]}, "intrinsics"),
        ({"width": "wide"}, "width"),
        ({"width": "4"}, "width"),
        ({"floor": [0, -1, float("nan"), 0.3]}, "floor"),
        ({"range": [0.5, float("inf")]}, "range"),
        ({"frames": []}, "frames"),
        ({"frames": {"000": {"stamp": -1}}}, "frames.000.stamp"),
        ({"frames": {"000": {"stamp": 1.5}}}, "frames.000.stamp"),
        ({"frames": {"000": {"stamp": 2**63}}}, "frames.000.stamp"),
        ({"frames": {"000": {"floor": [1, 2]}}}, "frames.000.floor"),
        ({"frames": {"000": 5}}, "frames.000"),
    ],
)
def test_a_camera_file_with_a_wrong_value_is_refused_by_its_key(folder, change, reason):
    depth_folder(folder, **change)
    with pytest.raises(ConfigError, match=f"camera.json: .*{reason}") as refused:
        played(folder, 30, loop=False)
    assert "\n" not in str(refused.value)


@pytest.mark.parametrize("text", ["", "{", "[]", "null", "5", '"camera"', "\x00", "{'width': 4}", "{}", "\udcff"])
def test_a_camera_file_that_is_none_is_refused(folder, text):
    (folder / "camera.json").write_bytes(text.encode(errors="surrogateescape"))
    with pytest.raises(ConfigError, match=r"camera\.json: ") as refused:
        played(folder, 30, loop=False)
    assert "\n" not in str(refused.value)


def test_a_folder_that_is_none_is_refused(tmp_path):
    for path in (tmp_path, tmp_path / "none"):
        with pytest.raises(ConfigError, match=r"camera\.json: No such file"):
            played(path, 30, loop=False)


def test_a_folder_without_frames_is_refused(tmp_path):
    with pytest.raises(ConfigError, match="no PNG"):
        played(depth_folder(tmp_path, count=0), 30, loop=False)


def test_the_configuration_opens_a_folder(folder):
    config = CaptureConfig(source="replay", path=str(folder), rate=30.0, loop=False)
    assert millimetres(frames_of(open_source(config), 3)) == [1000, 1001, 1002]


def test_a_frame_without_a_floor_is_bad(folder):
    with pytest.raises(BadFrame, match=r"000: camera\.json has no floor for it"):
        played(depth_folder(folder, floor=GONE), 30, loop=False).read(0.1)


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        ({"floor": [0, 0, 0, 0.3]}, "floor: the normal has length"),
        ({"intrinsics": [0, 4, 1, 1]}, "intrinsics: fx"),
        ({"range": [4.5, 0.5], "floor": GONE}, "range"),
        ({"place": [5.1, 0, 0]}, "place: x of 5.1 m is impossible, expected 5 m to either side at most"),
        ({"place": [0, -1e9, 0]}, r"place: y of -1e\+09 m"),
        ({"place": [0, 0, 90]}, r"place: yaw of 90 rad is impossible, expected one turn at most; is it in degrees\?"),
        ({"range": [500, 4500]}, r"range: \[500.0, 4500.0\] m is impossible; is it in millimetres\?"),
    ],
)
def test_a_camera_that_no_frame_can_have_is_refused(folder, change, reason):
    with pytest.raises(ConfigError, match=rf"camera\.json: {reason}"):
        played(depth_folder(folder, **change), 30, loop=False)


@pytest.mark.parametrize(("width", "height"), [(1, 3), (4096, 4096)])
def test_a_size_that_no_consumer_takes_is_not_sent(folder, width, height):
    depth_folder(folder, count=0, width=width, height=height, intrinsics=[width, height, 1, 1])
    build.write_png(folder / "000.png", np.zeros((height, width), np.uint16))
    with pytest.raises((ConfigError, BadFrame)):
        played(folder, 30, loop=False).read(0.1)


def test_a_frame_of_an_impossible_camera_costs_itself_only(tmp_path, clock):
    folder = depth_folder(tmp_path, frames={"001": {"floor": [0, 0, -1, 0.3]}, "ghost": {"stamp": 3}})
    source = played(folder, 30, loop=False)
    assert millimetres([source.read(0.1)]) == [1000]
    with pytest.raises(BadFrame, match=r"001: camera\.json: floor"):
        source.read(0.1)
    assert millimetres([source.read(0.1)]) == [1002]


def test_a_floor_may_come_with_the_frames_only(tmp_path, clock):
    floors = {f"{n:03}": {"floor": [0, -1, 0, 0.1 + n]} for n in range(3)}
    source = played(depth_folder(tmp_path, floor=GONE, frames=floors), 30, loop=False)
    assert [frame.camera.floor.d for frame in frames_of(source, 3)] == [0.1, 1.1, 2.1]


def test_keys_nobody_knows_are_ignored(folder):
    about = json.loads((folder / "camera.json").read_text()) | {"source": "a robot", "frames": {"000": {"pose": [1]}}}
    (folder / "camera.json").write_text(json.dumps(about))
    assert millimetres(frames_of(played(folder, 30, loop=False), 1)) == [1000]


@pytest.mark.parametrize("loop", [True, False])
def test_a_folder_without_a_good_frame_ends_with_the_remedy(folder, loop):
    for png in folder.glob("*.png"):
        png.write_bytes(b"")
    source = played(folder, 30, loop)
    for _ in range(3):
        with pytest.raises(BadFrame):
            source.read(0.1)
    with pytest.raises(ConfigError, match="no image in it can be used; `cliffscan check-data` says why"):
        source.read(0.1)
