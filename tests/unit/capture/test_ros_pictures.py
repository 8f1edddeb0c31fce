"""Depth images of ROS become millimetres; one that lies is refused with the reason."""

import io
import math
import struct

import numpy as np
import pytest
from PIL import Image

from cliffscan.services.capture.ros.pictures import CompressedPicture, Picture
from cliffscan.services.capture.sources.depth_source import BadFrame

MILLIMETRES = np.array([[0, 500, 1000], [1500, 2000, 65535]], np.uint16)


def picture(pixels, encoding, step=None, **changes):
    """An Image whose rows may be longer than their pixels."""
    rows = np.ascontiguousarray(pixels).view(np.uint8).reshape(len(pixels), -1)
    step = step or rows.shape[1]
    padded = np.full((len(rows), step), 255, np.uint8)
    padded[:, : rows.shape[1]] = rows
    fields = {"encoding": encoding, "big_endian": False, "step": step, "data": padded.ravel()}
    return Picture(7, "eye", *np.shape(pixels), **(fields | changes))


def png(pixels):
    buffer = io.BytesIO()
    Image.fromarray(pixels).save(buffer, "PNG")
    return buffer.getvalue()


def compressed(content, told, a=0.0, b=0.0):
    return CompressedPicture(7, "eye", told, np.frombuffer(struct.pack("<iff", 1, a, b) + content, np.uint8))


@pytest.mark.parametrize("step", [None, 7, 16])
def test_16uc1_is_millimetres_however_long_its_rows_are(step):
    np.testing.assert_array_equal(picture(MILLIMETRES, "16UC1", step).millimetres(3, 2), MILLIMETRES)


@pytest.mark.parametrize("step", [None, 13, 20])
def test_32fc1_is_metres_and_what_is_no_depth_is_no_return(step):
    metres = np.array([[math.nan, math.inf, -math.inf], [-1.0, 0.0004, 65.6], [0.0006, 1.2344, 65.535]], np.float32)
    expected = [[0, 0, 0], [0, 0, 0], [1, 1234, 65535]]
    np.testing.assert_array_equal(picture(metres, "32FC1", step).millimetres(3, 3), expected)


def test_the_depths_are_in_a_buffer_of_their_own():
    source = picture(MILLIMETRES, "16UC1")
    depth = source.millimetres(3, 2)
    source.data[:] = 1
    np.testing.assert_array_equal(depth, MILLIMETRES)


@pytest.mark.parametrize("told", ["16UC1; compressedDepth png", "16UC1; compressedDepth", "16UC1"])
def test_a_compressed_picture_of_millimetres(told):
    np.testing.assert_array_equal(compressed(png(MILLIMETRES), told).millimetres(3, 2), MILLIMETRES)


def test_a_compressed_picture_of_metres_is_inverse_depth():
    """As compressed_depth_image_transport's encoder has it: depth_max 10 m, depth_quantization 100."""
    a = 100.0 * (100.0 + 1.0)
    b = 1.0 - a / 10.0
    metres = np.array([[0.6, 1.0, 2.0], [4.0, 8.0, 10.0]])
    levels = (a / metres + b + 0.5).astype(np.uint16)
    levels[0, 0] = 0
    got = compressed(png(levels), "32FC1; compressedDepth png", a, b).millimetres(3, 2)
    assert got[0, 0] == 0
    np.testing.assert_allclose(got.ravel()[1:], 1000 * metres.ravel()[1:], rtol=0.01)


@pytest.mark.parametrize("level", [9, 10])
def test_a_level_beyond_infinity_is_no_return(level):
    levels = np.full((2, 3), level, np.uint16)
    assert not compressed(png(levels), "32FC1; compressedDepth png", 100.0, 10.0).millimetres(3, 2).any()


@pytest.mark.parametrize(
    ("changes", "why"),
    [
        ({"encoding": "rgb8"}, "'rgb8' is no depth, expected 16UC1 or 32FC1"),
        ({"encoding": ""}, "is no depth"),
        ({"big_endian": True}, "big-endian"),
        ({"step": 5}, "step 5 for 3 pixels 16UC1, expected 6"),
        ({"step": 0}, "step 0"),
        ({"step": 8}, "12 bytes, expected 2 rows of 8"),
        ({"step": 2**32 - 1}, "12 bytes"),
        ({"data": np.zeros(11, np.uint8)}, "11 bytes, expected 2 rows of 6"),
        ({"data": np.zeros(13, np.uint8)}, "13 bytes"),
        ({"data": np.zeros(0, np.uint8)}, "0 bytes"),
        ({"encoding": "32FC1"}, "step 6 for 3 pixels 32FC1, expected 12"),
    ],
)
def test_an_image_that_lies_is_refused(changes, why):
    with pytest.raises(BadFrame, match=why):
        picture(MILLIMETRES, "16UC1")._replace(**changes).millimetres(3, 2)


@pytest.mark.parametrize("size", [(2, 3), (3, 3), (4000, 4000)])
def test_an_image_of_another_size_than_its_camera_info_is_refused(size):
    with pytest.raises(BadFrame, match=f"3x2 pixels, its CameraInfo {size[0]}x{size[1]}"):
        picture(MILLIMETRES, "16UC1").millimetres(*size)
    with pytest.raises(BadFrame, match="3x2"):
        compressed(png(MILLIMETRES), "16UC1").millimetres(*size)


@pytest.mark.parametrize(
    ("content", "told", "why"),
    [
        (b"\x80\x02\x00\x00RVL.", "16UC1; compressedDepth rvl", "rvl.*set the driver's compressedDepth format to png"),
        (b"", "16UC1; compressedDepth png", "no PNG"),
        (png(MILLIMETRES)[:-20], "16UC1; compressedDepth png", "compressedDepth: "),
        (png(MILLIMETRES.astype(np.uint8)), "16UC1; compressedDepth png", "expected 3x2 16-bit grey"),
        (png(MILLIMETRES), "rgb8; jpeg compressed bgr8", "'rgb8' is no depth"),
    ],
)
def test_a_compressed_picture_that_is_none_is_refused(content, told, why):
    with pytest.raises(BadFrame, match=why):
        compressed(content, told).millimetres(3, 2)


def test_a_picture_shorter_than_its_head_is_refused():
    with pytest.raises(BadFrame, match="no PNG"):
        CompressedPicture(7, "eye", "32FC1; compressedDepth png", np.zeros(3, np.uint8)).millimetres(3, 2)
