"""Each message is read field by field: what the contract allows is taken, anything else is refused by name."""

import math

import msgpack
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from cliffscan.common.contract import depth_codec
from cliffscan.common.contract.camera import KINECT_BASELINE, KINECT_NOISE
from cliffscan.common.contract.message import MessageError
from cliffscan.common.contract.messages import DepthImage, LaserScan, ServiceStatus
from tests import build
from tests.build import GONE, SECOND

KINDS = {DepthImage: build.depth_fields, LaserScan: build.scan_fields, ServiceStatus: build.status_fields}
FIELDS = [(kind, name) for kind, fields in KINDS.items() for name in fields()]


def decode(kind, **changes):
    return kind.decode(build.payload(KINDS[kind](**changes)))


def floats(*values):
    return np.array(values, "<f4").tobytes()


@pytest.mark.parametrize("kind", KINDS)
def test_what_a_foreign_client_sends_is_read_as_it_was_meant(kind):
    fields = KINDS[kind]()
    message = kind.decode(build.payload(fields))
    for name, sent in fields.items():
        read = getattr(message, name)
        if isinstance(read, np.ndarray):
            assert read.tobytes() == sent
        else:
            assert read == (tuple(sent) if isinstance(sent, list) else sent)


def test_the_pixels_of_a_foreign_frame_run_by_rows_from_the_top_left():
    image = decode(DepthImage)
    np.testing.assert_array_equal(image.depth, [[0, 500, 1000], [1500, 2000, 65535]])
    assert image.depth.dtype == np.uint16
    assert image.camera.floor.d == 0.3
    assert (image.camera.intrinsics.fx, image.camera.intrinsics.fy) == (3.0, 2.5)


OPTIONAL = {"clear", "noise", "baseline", "region", "period"}


def test_a_frame_that_does_not_describe_its_sensor_is_a_kinects():
    camera = decode(DepthImage, noise=GONE, baseline=GONE, region=GONE).camera
    assert (camera.noise, camera.baseline, camera.region) == (KINECT_NOISE, KINECT_BASELINE, (0, 0, 2, 1))


@pytest.mark.parametrize(
    "region", [[0, 0, 3, 1], [0, 0, 2, 2], [-1, 0, 2, 1], [1, 0, 1, 1], [0, 1, 2, 0], [0.0, 0, 2, 1]]
)
def test_a_region_that_is_not_in_the_image_is_refused(region):
    with pytest.raises(MessageError, match="region"):
        decode(DepthImage, region=region)


@pytest.mark.parametrize(("name", "value"), [("noise", 0.0), ("noise", 0.2), ("baseline", -0.1), ("baseline", 2.0)])
def test_a_sensor_that_cannot_be_is_refused(name, value):
    with pytest.raises(MessageError, match=name):
        decode(DepthImage, **{name: value})


def test_a_frame_that_does_not_tell_its_period_has_none():
    assert decode(DepthImage, period=GONE).period == 0.0


@pytest.mark.parametrize(("kind", "name"), [pair for pair in FIELDS if pair[1] not in OPTIONAL])
def test_a_missing_field_is_named(kind, name):
    with pytest.raises(MessageError, match=f"(^|; ){name}: Field required"):
        decode(kind, **{name: GONE})


@pytest.mark.parametrize("wrong", [None, {"a": 1}, [], [[1.0, 2.0]], True])
@pytest.mark.parametrize(("kind", "name"), [pair for pair in FIELDS if pair[1] != "counts"])
def test_a_field_of_another_type_is_named(kind, name, wrong):
    with pytest.raises(MessageError, match=f"(^|; ){name}[.:]"):
        decode(kind, **{name: wrong})


@pytest.mark.parametrize("wrong", ["7", 7.0, -1, 2**64 - 1, b"7"])
@pytest.mark.parametrize("kind", KINDS)
def test_a_stamp_is_a_whole_number_of_nanoseconds(kind, wrong):
    with pytest.raises(MessageError, match="stamp"):
        decode(kind, stamp=wrong)


@pytest.mark.parametrize("wrong", ["640", 640.0, -640, 1, 0, 2**22, 2**63])
@pytest.mark.parametrize("side", ["width", "height"])
def test_a_frame_of_no_size_or_an_absurd_one_is_refused(side, wrong):
    with pytest.raises(MessageError, match=side):
        decode(DepthImage, **{side: wrong})


LISTS = ["intrinsics", "range", "floor"]
FLOATS = [name for name, value in build.scan_fields().items() if isinstance(value, float)]


@pytest.mark.parametrize("wrong", [math.nan, math.inf, -math.inf, "1", None, True, [1.0]])
@pytest.mark.parametrize("name", LISTS)
def test_a_camera_of_what_is_no_finite_number_is_refused(name, wrong):
    sent = build.depth_fields()[name]
    for place in range(len(sent)):
        with pytest.raises(MessageError, match=rf"{name}\.{place}"):
            decode(DepthImage, **{name: [*sent[:place], wrong, *sent[place + 1 :]]})


@pytest.mark.parametrize("wrong", [math.nan, math.inf, -math.inf, "1", b"1", True])
@pytest.mark.parametrize("name", FLOATS)
def test_a_scan_of_what_is_no_finite_number_is_refused(name, wrong):
    with pytest.raises(MessageError, match=name):
        decode(LaserScan, **{name: wrong})


@pytest.mark.parametrize("name", LISTS)
def test_a_list_is_neither_shorter_nor_longer(name):
    sent = build.depth_fields()[name]
    for wrong in (sent[:-1], [*sent, 1.0], [*sent] * 100):
        with pytest.raises(MessageError, match=name):
            decode(DepthImage, **{name: wrong})


def test_whole_numbers_are_floats_where_floats_are_expected():
    image = decode(DepthImage, intrinsics=[3, 3, 1, 0], range=[1, 4], floor=[0, -1, 0, 1])
    assert image.range == (1.0, 4.0)
    assert decode(LaserScan, angle_min=0, angle_max=1, range_max=4, time_increment=0).range_max == 4.0
    assert decode(ServiceStatus, uptime=3, rate=30, latency=[0, 1]).latency == (0.0, 1.0)


def test_numbers_may_be_single_precision():
    fields = build.scan_fields(scan_time=0.5, range_max=4.5)
    assert LaserScan.decode(msgpack.packb(fields, use_single_float=True)).range_max == 4.5


@pytest.mark.parametrize("kind", KINDS)
def test_unknown_keys_are_ignored(kind):
    assert decode(kind, colour="red", more={"a": [1, 2]}, also=None) is not None


IMPOSSIBLE = {
    "fx": {"intrinsics": [0.2, 2.0, 1.0, 0.5]},
    "fy": {"intrinsics": [3.0, -2.0, 1.0, 0.5]},
    "cx": {"intrinsics": [3.0, 2.0, 7.0, 0.5]},
    "cy": {"intrinsics": [3.0, 2.0, 1.0, -3.0]},
    "range.*impossible": {"range": [4.5, 0.5]},
    "range.*0.5, 0.5.*impossible": {"range": [0.5, 0.5]},
    "range.*-1": {"range": [-1, 0.5]},
    "floor.*length 0.000": {"floor": [0, 0, 0, 0.3]},
    "floor.*length 1.1": {"floor": [0, -1.1, 0, 0.3]},
    "floor.*straight down": {"floor": [0, 0, -1, 0.3]},
    "floor.*straight down or up": {"floor": [0.01, 0, 1, 0.3]},
    "floor.*height of 0": {"floor": [0, -1, 0, 0]},
    "floor.*height of -0.3": {"floor": [0, -1, 0, -0.3]},
    "floor.*height of 21": {"floor": [0, -1, 0, 21]},
    "12 bytes, expected 16": {"width": 4},
    "11 bytes, expected 12": {"data": bytes(11)},
    "0 bytes, expected 12": {"data": b""},
    "unknown encoding '32FC1'": {"encoding": "32FC1"},
    "unknown encoding ''": {"encoding": ""},
    "data.*bytes": {"data": "twelve chars"},
    "too short for": {"encoding": depth_codec.LEVELS, "data": b"\x01\x00"},
}


@pytest.mark.parametrize("reason", IMPOSSIBLE)
def test_an_impossible_frame_is_refused_with_its_reason(reason):
    with pytest.raises(MessageError, match=reason):
        decode(DepthImage, **IMPOSSIBLE[reason])


CONTRADICTIONS = {
    "0 beams": {"ranges": b"", "intensities": b""},
    "ranges: .*whole number of float32": {"ranges": bytes(13)},
    "intensities: 2 values for 3": {"intensities": floats(1, 1)},
    "intensities: not finite": {"intensities": floats(1, math.nan, 1)},
    "clear: 2 values for 3": {"clear": floats(1, 1)},
    "clear: not finite": {"clear": floats(1, math.inf, 1)},
    "clear: negative": {"clear": floats(1, -0.1, 1)},
    "ranges: negative": {"ranges": floats(1, -0.1, 1)},
    "ranges: negative$": {"ranges": floats(1, -math.inf, 1)},
    "angle_max: 2.0, expected 0.5": {"angle_max": 2.0},
    "angle_max.*expected": {"angle_max": -0.5},
    "angle_increment.*greater than or equal to": {"angle_increment": 0.0},
    "angle_increment": {"angle_increment": -0.5, "angle_min": 0.5, "angle_max": -0.5},
    "time_increment": {"time_increment": -0.1},
    "scan_time": {"scan_time": -0.1},
    "range_min": {"range_min": -0.1},
    "range_max": {"range_max": 0},
    "range_max: 1.0 is below": {"range_min": 1.1, "range_max": 1},
    "ranges: .*expected bin, got list": {"ranges": [1.0, 2.0, 3.0]},
    "seq": {"seq": -1},
}


@pytest.mark.parametrize("reason", CONTRADICTIONS)
def test_a_scan_that_contradicts_itself_is_refused_with_its_reason(reason):
    with pytest.raises(MessageError, match=reason):
        decode(LaserScan, **CONTRADICTIONS[reason])


@pytest.mark.parametrize("slack", [-0.5, 0.5])
def test_a_driver_may_count_the_last_beam_or_not(slack):
    assert decode(LaserScan, angle_max=0.5 + slack).angle_max == 0.5 + slack


@pytest.mark.parametrize("beams", [359, 360, 361])
def test_a_scan_may_go_all_round(beams):
    assert len(build.scan([1.0] * beams, angle_min=-math.pi, increment=math.radians(1)).ranges) == beams


@pytest.mark.parametrize("beams", [363, 720])
def test_a_scan_does_not_go_round_twice(beams):
    with pytest.raises(MessageError, match="more than a turn"):
        build.scan([1.0] * beams, angle_min=-math.pi, increment=math.radians(1))


def test_a_scan_may_come_without_intensities():
    assert len(decode(LaserScan, intensities=b"").intensities) == 0


def test_a_scan_need_not_tell_how_far_floor_was_seen():
    assert len(decode(LaserScan, clear=GONE).clear) == 0


@pytest.mark.parametrize(
    ("clear", "free"),
    [(b"", (1.0, 4.5, 0.0)), (floats(0.5, 5.0, 0.5), (0.5, 4.5, 0.5)), (floats(2.0, 2.0, 0.0), (1.0, 2.0, 0.0))],
)
def test_a_beam_is_free_up_to_where_floor_was_seen(clear, free):
    np.testing.assert_array_equal(decode(LaserScan, clear=clear).free(), free)


@pytest.mark.parametrize(
    ("name", "wrong"),
    [
        *(("counts", wrong) for wrong in ({"received": -1}, {"received": 1.0}, {"x": None}, [])),
        *(("latency", wrong) for wrong in ([0.1], [math.inf, 1.0], [0.1, 0.2, 0.3])),
        *(("pid", wrong) for wrong in (-1, 1.0, 2**64 - 0.5)),
        ("state", "fine"),
        ("rate", math.nan),
    ],
)
def test_a_status_that_cannot_be_is_refused(name, wrong):
    with pytest.raises(MessageError, match=name):
        decode(ServiceStatus, **{name: wrong})


@given(st.integers(0, 2**64 - 1), st.integers(0, 2**63 - 1), st.text(max_size=20))
def test_the_largest_numbers_and_any_name_pass(seq, stamp, frame):
    image = decode(DepthImage, seq=seq, stamp=stamp, frame=frame)
    assert (image.seq, image.stamp, image.frame) == (seq, stamp, frame)
    assert decode(LaserScan, seq=seq, stamp=stamp, frame=frame).stamp == stamp


def test_every_wrong_field_is_named_at_once():
    with pytest.raises(MessageError) as refused:
        decode(LaserScan, stamp=SECOND * 1.5, frame=3, scan_time=GONE)
    assert str(refused.value).count("; ") == 2
    assert "\n" not in str(refused.value)
