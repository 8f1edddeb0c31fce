"""Depth images come back from their bytes bit by bit; bytes that hold none are refused with a ValueError."""

import subprocess
import sys

import numpy as np
import pytest
import zstandard
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import array_shapes, arrays

from cliffscan.common.contract.depth_codec import ENCODINGS, LEVELS, RAW, SMALL, decode, encode
from tests import naive_codec, scenes

shapes = array_shapes(min_dims=2, max_dims=2, min_side=2, max_side=24)


def assert_lossless(depth, encoding):
    rows, columns = depth.shape
    back = decode(encode(depth, encoding), encoding, columns, rows)
    assert back.dtype == np.uint16
    assert back.shape == depth.shape
    np.testing.assert_array_equal(back, depth)


@pytest.mark.parametrize("encoding", ENCODINGS)
@given(st.data())
def test_any_image_comes_back(encoding, data):
    assert_lossless(data.draw(arrays(np.uint16, shapes)), encoding)


@pytest.mark.parametrize("encoding", ENCODINGS)
@settings(max_examples=25)
@given(st.integers(2, 40), st.integers(2, 40), st.integers(1, 65535), st.integers(0, 2**32 - 1))
def test_noise_of_any_span_comes_back(encoding, rows, columns, largest, seed):
    noise = np.random.default_rng(seed).integers(0, largest, (rows, columns), endpoint=True)
    assert_lossless(noise.astype(np.uint16), encoding)


@pytest.mark.parametrize("encoding", ENCODINGS)
@pytest.mark.parametrize("value", [0, 1, 255, 256, 32767, 32768, 65535])
@pytest.mark.parametrize("shape", [(2, 2), (2, 640), (480, 2), (3, 5)])
def test_an_image_of_one_depth_comes_back(encoding, value, shape):
    assert_lossless(np.full(shape, value, np.uint16), encoding)


@pytest.mark.parametrize("encoding", ENCODINGS)
@pytest.mark.parametrize("missing", [1, 0], ids=["65535 depths", "65536 depths"])
def test_an_image_of_all_depths_there_are_comes_back(encoding, missing):
    depth = np.arange(65536, dtype=np.uint16).reshape(256, 256)
    depth[0, :missing] = 1
    assert_lossless(np.random.default_rng(0).permuted(depth), encoding)


@pytest.mark.parametrize("encoding", ENCODINGS)
def test_the_longest_steps_between_neighbours_come_back(encoding):
    depth = np.tile(np.arange(65535, dtype=np.uint16), 2).reshape(2, -1)
    depth[0, 1::2] = depth[0, 1::2][::-1]
    assert_lossless(depth, encoding)


def test_more_effort_takes_fewer_bytes_for_the_same_image():
    depth = scenes.depth(scenes.camera(320, 240), [scenes.HOLE])
    noisy = depth + np.random.default_rng(2).integers(0, 2, depth.shape).astype(np.uint16)
    small = encode(noisy, LEVELS, SMALL)
    assert len(small) < len(encode(noisy, LEVELS))
    np.testing.assert_array_equal(decode(small, LEVELS, 320, 240), noisy)


@pytest.mark.parametrize("order", ["F", "C"])
@pytest.mark.parametrize("encoding", ENCODINGS)
def test_how_an_image_lies_in_memory_does_not_matter(encoding, order):
    depth = np.random.default_rng(1).integers(0, 5000, (14, 20)).astype(np.uint16, order=order)
    assert_lossless(depth, encoding)
    assert_lossless(depth[::2, ::-3], encoding)


@given(st.data())
def test_bytes_and_depths_are_those_of_the_slow_twin(data):
    depth = data.draw(arrays(np.uint16, shapes))
    assert_as_the_twin(depth)


@pytest.mark.parametrize("seed", range(3))
def test_all_depths_there_are_make_the_bytes_of_the_slow_twin(seed):
    depth = np.random.default_rng(seed).permuted(np.arange(65536, dtype=np.uint16).reshape(128, 512))
    assert_as_the_twin(depth)


def test_a_kinects_frame_makes_the_bytes_of_the_slow_twin():
    assert_as_the_twin(scenes.depth(scenes.camera(160, 120), [scenes.HOLE]))


def assert_as_the_twin(depth):
    rows, columns = depth.shape
    data = encode(depth, LEVELS)
    assert data == naive_codec.encode(depth)
    np.testing.assert_array_equal(decode(data, LEVELS, columns, rows), naive_codec.decode(data, columns, rows))


def test_a_process_that_only_encodes_loads_no_compiler():
    code = (
        "import sys, numpy as np\n"
        "from cliffscan.common.contract.depth_codec import LEVELS, encode\n"
        "import cliffscan.services.capture.__main__, cliffscan.services.capture.sources.replay\n"
        "import cliffscan.services.capture.sources.kinect\n"
        "encode(np.zeros((2, 2), np.uint16), LEVELS)\n"
        "assert 'numba' not in sys.modules"
    )
    subprocess.run([sys.executable, "-c", code], check=True, timeout=60)


def test_the_levels_come_first_ascending_and_little_endian():
    data = encode(np.array([[700, 700], [0, 258]], np.uint16), LEVELS)
    assert data[:8] == b"\x03\x00" + b"\x00\x00" + b"\x02\x01" + b"\xbc\x02"
    planes = zstandard.ZstdDecompressor().decompress(data[8:])
    assert planes == bytes([4, 0, 0, 2]) + bytes(4)  # steps 2 0 / 0 1, folded, low bytes and then high ones


def test_a_kinects_frame_shrinks_to_an_eighth():
    depth = scenes.depth(scenes.camera(640, 480), [scenes.HOLE])
    assert len(encode(depth, LEVELS)) < depth.nbytes / 8


def test_an_unknown_encoding_is_refused():
    with pytest.raises(ValueError, match="unknown encoding 'png'"):
        decode(b"", "png", 2, 2)


@pytest.mark.parametrize("length", [0, 1, 7, 9, 16])
def test_raw_bytes_of_another_size_are_refused(length):
    with pytest.raises(ValueError, match=f"{length} bytes, expected 8 for 2x2"):
        decode(bytes(length), RAW, 2, 2)


GOOD = encode(np.array([[700, 700, 5], [0, 258, 9]], np.uint16), LEVELS)


@pytest.mark.parametrize("length", range(len(GOOD)))
def test_a_frame_cut_short_is_refused(length):
    with pytest.raises(ValueError, match=r"too short|zstandard|holds"):
        decode(GOOD[:length], LEVELS, 3, 2)


@pytest.mark.parametrize(("width", "height"), [(2, 2), (4, 2), (3, 3), (640, 480)])
def test_a_frame_of_another_size_is_refused(width, height):
    with pytest.raises(ValueError, match=f"holds 12 bytes, expected {2 * width * height}"):
        decode(GOOD, LEVELS, width, height)


def test_a_pixel_of_no_level_is_refused():
    planes = zstandard.ZstdCompressor().compress(bytes([0, 2, 0, 0]) + bytes(4))
    with pytest.raises(ValueError, match="names level 1 of 1"):
        decode(b"\x01\x00\x05\x00" + planes, LEVELS, 2, 2)


def test_an_image_without_levels_is_refused():
    with pytest.raises(ValueError, match="too short for 65536 levels"):
        decode(b"\x00\x00" + zstandard.ZstdCompressor().compress(bytes(8)), LEVELS, 2, 2)


def test_more_than_the_image_is_refused():
    with pytest.raises(ValueError, match=r"bytes"):
        decode(GOOD + b"what is this?", LEVELS, 3, 2)


@given(st.sampled_from(ENCODINGS), st.binary(max_size=60))
def test_any_bytes_hold_an_image_or_are_refused(encoding, data):
    read_or_refuse(data, encoding)


@given(st.lists(st.tuples(st.integers(0, len(GOOD) - 1), st.integers(0, 255)), min_size=1, max_size=4))
def test_any_changed_bytes_hold_an_image_or_are_refused(changes):
    data = bytearray(GOOD)
    for place, value in changes:
        data[place] = value
    read_or_refuse(bytes(data), LEVELS)


@given(st.integers(0, 9), st.binary(min_size=12, max_size=12))
def test_any_planes_hold_an_image_or_are_refused(count, planes):
    levels = np.arange(count, dtype="<u2").tobytes()
    data = count.to_bytes(2, "little") + levels + zstandard.ZstdCompressor().compress(planes)
    read_or_refuse(data, LEVELS)


def read_or_refuse(data, encoding):
    try:
        image = decode(data, encoding, 3, 2)
    except ValueError:
        return
    assert image.shape == (2, 3)
    assert image.dtype == np.uint16
