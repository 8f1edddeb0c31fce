"""What we send anybody can read; what anybody sends is read or refused, and nothing else happens."""

import tracemalloc

import msgpack
import numpy as np
import pytest
import zstandard
from hypothesis import example, given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import array_shapes, arrays

from cliffscan.common.contract.beam_fields import BEAM_FIELDS
from cliffscan.common.contract.depth_codec import LEVELS, RAW
from cliffscan.common.contract.message import MessageError
from cliffscan.common.contract.messages import DepthImage, LaserScan, ServiceStatus
from tests import build

KINDS = {DepthImage: build.depth_fields, LaserScan: build.scan_fields, ServiceStatus: build.status_fields}
finite = st.floats(-1e6, 1e6)
images = arrays(np.uint16, array_shapes(min_dims=2, max_dims=2, min_side=2, max_side=12))


def plain(message):
    """What a client with nothing but msgpack reads."""
    return msgpack.unpackb(message.encode())


def camera_of(depth):
    rows, columns = depth.shape
    return build.camera(columns, rows, focal=12.0)


@pytest.mark.parametrize("kind", KINDS)
def test_a_schema_has_the_messages_name_and_version(kind):
    assert kind.schema_name() == f"cliffscan.{kind.__name__}.v1"


def test_a_raw_frame_is_little_endian_rows_of_millimetres():
    depth = np.array([[1, 256, 65535], [0, 513, 7]], np.uint16)
    sent = plain(DepthImage.pack(3, 9, "camera", depth, camera_of(depth), RAW))
    assert sent["data"] == bytes([1, 0, 0, 1, 255, 255, 0, 0, 1, 2, 7, 0])
    assert list(sent) == list(build.depth_fields())
    assert (sent["width"], sent["height"], sent["encoding"], sent["seq"], sent["stamp"]) == (3, 2, "16UC1", 3, 9)
    assert sent["floor"] == [0.0, -1.0, 0.0, 0.3]
    assert sent["range"] == [0.5, 4.5]
    assert sent["intrinsics"] == [12.0, 12.0, 1, 1]


def test_a_scan_is_little_endian_single_precision():
    fields = build.scan_fields()
    fields |= {name: np.frombuffer(fields[name], "<f4").astype(">f4") for name in BEAM_FIELDS}
    sent = plain(LaserScan.of(fields))
    assert list(sent) == list(build.scan_fields())
    assert sent["ranges"] == b"\x00\x00\x80\x3f\x00\x00\x80\x7f\x00\x00\xc0\x7f"
    assert sent["intensities"] == b"\x00\x00\x00\x40" + bytes(8)
    assert {type(sent[name]) for name in ("angle_min", "scan_time", "range_max")} == {float}


@pytest.mark.parametrize("kind", KINDS)
def test_what_was_read_is_sent_on_unchanged(kind):
    fields = KINDS[kind]()
    assert plain(kind.decode(build.payload(fields))) == fields


@given(images, st.sampled_from([RAW, LEVELS]), st.integers(0, 2**64 - 1), st.integers(0, 2**63 - 1))
def test_a_frame_comes_back_as_it_was_sent(depth, encoding, seq, stamp):
    camera = camera_of(depth)
    image = DepthImage.decode(DepthImage.pack(seq, stamp, "camera", depth, camera, encoding).encode())
    np.testing.assert_array_equal(image.depth, depth)
    assert image.depth.dtype == np.uint16
    assert (image.camera, image.seq, image.stamp) == (camera, seq, stamp)


@given(arrays(np.float32, st.integers(2, 50), elements=st.floats(0, 100, width=32) | st.sampled_from([np.nan, np.inf])))
def test_a_scan_comes_back_as_it_was_sent(ranges):
    sent = build.scan(ranges, np.isfinite(ranges).astype(np.float32))
    back = LaserScan.decode(sent.encode())
    np.testing.assert_array_equal(back.ranges, ranges)
    np.testing.assert_array_equal(back.intensities, np.isfinite(ranges))
    assert back.model_dump(exclude=set(BEAM_FIELDS)) == sent.model_dump(exclude=set(BEAM_FIELDS))


@given(st.dictionaries(st.text(), st.integers(0, 2**64 - 1)), st.floats(0, 1e6), finite, st.text())
def test_a_status_comes_back_as_it_was_sent(counts, rate, uptime, note):
    sent = ServiceStatus.of(build.status_fields(counts=counts, rate=rate, uptime=uptime, note=note, latency=(0.1, 2)))
    assert ServiceStatus.decode(sent.encode()) == sent


def decode_or_refuse(kind, data):
    refusal = "."
    try:
        kind.decode(data)
    except MessageError as error:
        refusal = str(error)
    assert len(refusal.splitlines()) == 1


@given(st.sampled_from(list(KINDS)), st.binary(max_size=200))
def test_any_bytes_are_read_or_refused(kind, data):
    decode_or_refuse(kind, data)


leaves = (
    st.none()
    | st.booleans()
    | st.integers(-(2**63), 2**64 - 1)
    | st.floats()
    | st.text(max_size=8)
    | st.binary(max_size=24)
    | st.builds(msgpack.ExtType, st.integers(0, 127), st.binary(max_size=4))
    | st.builds(msgpack.Timestamp, st.integers(-5, 2**34), st.integers(0, 999_999_999))
)
anything = st.recursive(leaves, lambda each: st.lists(each) | st.dictionaries(st.text(max_size=8), each), max_leaves=8)


@given(st.sampled_from(list(KINDS)), anything)
@example(LaserScan, {1: 2})
@example(LaserScan, {b"seq": 7})
def test_any_structure_is_read_or_refused(kind, structure):
    decode_or_refuse(kind, msgpack.packb(structure))


@settings(max_examples=150)
@given(st.sampled_from(list(KINDS)), st.data())
def test_a_message_with_any_field_replaced_is_read_or_refused(kind, data):
    fields = KINDS[kind]()
    names = data.draw(st.lists(st.sampled_from(sorted(fields)), min_size=1, max_size=3))
    decode_or_refuse(kind, msgpack.packb(fields | {name: data.draw(anything) for name in names}))


@given(st.sampled_from(list(KINDS)), st.data())
def test_a_message_with_any_bytes_changed_is_read_or_refused(kind, data):
    good = bytearray(build.payload(KINDS[kind]()))
    for place in data.draw(st.lists(st.integers(0, len(good) - 1), min_size=1, max_size=4)):
        good[place] = data.draw(st.integers(0, 255))
    decode_or_refuse(kind, bytes(good[: data.draw(st.integers(0, len(good)))]))


@pytest.mark.parametrize(
    "data",
    [b"", b"\xc1", b"\x81", b"\x80\x80", b"\x93\1\2\3", b"\xc0", b"\xa1\xff", b"\x91" * 5000, b"\xdd\xff\xff\xff\xff"],
)
def test_what_is_no_map_is_refused(data):
    with pytest.raises(MessageError, match=r"not msgpack|expected a map"):
        LaserScan.decode(data)


def levels_frame(claimed_pixels, sent_pixels, width, height):
    """A LEVELS frame of zeros whose compressed part says it holds `claimed_pixels`."""
    data = b"\x01\x00\x00\x00" + zstandard.ZstdCompressor().compress(bytes(2 * sent_pixels))
    assert zstandard.frame_content_size(data[4:]) == 2 * claimed_pixels
    return build.depth_fields(
        width=width, height=height, encoding=LEVELS, data=data, intrinsics=[width, width, width / 2, height / 2]
    )


def memory_to_refuse(fields):
    data = build.payload(fields)
    tracemalloc.start()
    try:
        with pytest.raises(MessageError, match=r"data|holds|expected|pixels|too"):
            DepthImage.decode(data)
        return tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()


def test_a_frame_that_unpacks_to_more_than_its_size_takes_no_memory():
    assert memory_to_refuse(levels_frame(10**7, 10**7, 640, 480)) < 100_000


def test_a_small_message_of_a_huge_frame_takes_no_memory():
    side = 4096
    assert memory_to_refuse(levels_frame(side**2, side**2, side, side)) < 1_000_000


@pytest.mark.parametrize(
    ("kind", "changes"),
    [
        (DepthImage, {"encoding": "x" * 20_000}),
        (DepthImage, {"floor": ["x"] * 20_000}),
        (ServiceStatus, {"counts": {"x" * 20_000: -1}}),
        (ServiceStatus, {"counts": {str(n): -1 for n in range(2_000)}}),
        (ServiceStatus, {"counts": {"one\nmalformed (1 so far): another": -1}}),
    ],
    ids=["a long word", "a long list", "a long key", "many keys", "two lines"],
)
def test_a_refusal_is_one_short_line_whatever_was_sent(kind, changes):
    with pytest.raises(MessageError) as refused:
        kind.decode(build.payload(KINDS[kind](**changes)))
    assert len(str(refused.value)) < 2000
    assert len(str(refused.value).splitlines()) == 1


@pytest.mark.parametrize("angle_max", [0.5e300, 3.0])
def test_beams_that_go_round_more_than_once_are_refused(angle_max):
    fields = build.scan_fields(angle_min=0.0, angle_increment=1e300 if angle_max > 9 else 1.7e308, angle_max=angle_max)
    with pytest.raises(MessageError, match="angle"):
        LaserScan.decode(build.payload(fields))


def test_a_scan_that_saw_nothing_at_all_is_a_scan():
    fields = build.scan_fields(ranges=np.full(3, np.nan, np.float32).tobytes())
    assert np.isnan(LaserScan.decode(build.payload(fields)).ranges).all()
