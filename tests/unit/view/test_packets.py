"""What travels to the page: read again here by the rules that packet.py writes down."""

import io
import json
import math
import struct

import numpy as np
import pytest
from matplotlib import colormaps
from PIL import Image

from cliffscan.common.contract.camera import Camera, FloorPlane, Intrinsics
from cliffscan.common.contract.evidence import Evidence
from cliffscan.common.contract.map_messages import OccupancyGrid
from cliffscan.common.contract.messages import DepthImage, LaserScan
from cliffscan.safety.pose2d import Pose2D
from cliffscan.view.depth_picture import coloured, depth_picture, edge_pixels
from cliffscan.view.map_picture import map_picture
from cliffscan.view.packet import numbered
from cliffscan.view.scene import FARTHEST, FREE, UNSEEN, millimetres, scene
from tests.build import SECOND, scan_fields

CAMERA = Camera(640, 480, Intrinsics(525.0, 525.0, 319.5, 239.5), (0.5, 4.5), FloorPlane(0.0, -1.0, 0.0, 0.30))


def read(body):
    """The number, the header and the arrays of a packet."""
    payload = numbered(7, body)
    number, length = struct.unpack_from("<II", payload)
    header = json.loads(payload[8 : 8 + length])
    arrays = {}
    for name, each in header.pop("arrays").items():
        assert (8 + length + each["at"]) % np.dtype(each["type"]).itemsize == 0
        arrays[name] = np.frombuffer(payload, "<" + each["type"], each["length"], 8 + length + each["at"])
    return number, header, arrays


def scan(ranges, evidence, clear=None, **changes):
    fields = scan_fields(
        ranges=np.array(ranges, "<f4").tobytes(),
        intensities=np.array(evidence, "<f4").tobytes(),
        clear=np.array(ranges if clear is None else clear, "<f4").tobytes(),
        **changes,
    )
    return LaserScan.of(fields)


def test_a_scene_has_each_beam_s_number_seen_floor_and_evidence():
    seen = scan([1.5, math.inf, math.nan], [2, 0, 0], [1.25, 4.0, 0.0])
    number, header, arrays = read(scene(seen, Pose2D(1.0, 2.0, 0.5), Pose2D(-0.1, 0.0, 0.0)))
    assert number == 7
    assert header["kind"] == "scene"
    assert header["pose"] == [1.0, 2.0, 0.5]
    assert header["camera"] == [-0.1, 0.0, 0.0]
    assert arrays["ranges"].tolist() == [1500, FREE, UNSEEN]
    assert arrays["clear"].tolist() == [1250, 4000, 1]
    assert arrays["evidence"].tolist() == [2, 0, 0]


def test_millimetres_are_never_mistaken_for_free_or_unseen():
    ranges = np.array([0.0, 1e-6, 65.5, 1e9, np.inf, np.nan], np.float32)
    assert millimetres(ranges).tolist() == [1, 1, 65500, FARTHEST, FREE, UNSEEN]


def test_an_edge_is_drawn_where_the_camera_sees_that_floor():
    """A level camera 0.30 m high: floor at x m straight ahead is in row cy + fy·0.30/x."""
    seen = scan([1.5, 2.0, 3.0], [Evidence.DROP, Evidence.FLOOR_LOST, Evidence.POSITIVE])
    u, v = edge_pixels(CAMERA, seen)
    assert v[1] == pytest.approx(239.5 + 525.0 * 0.30 / 2.0)
    assert u[1] == pytest.approx(319.5)
    assert u[0] > u[1]  # the first beam is the rightmost
    assert np.isnan([u[2], v[2]]).all()  # an obstacle is no edge


def test_a_depth_picture_is_a_jpeg_of_the_image():
    depth = np.full((480, 640), 2000, np.uint16)
    depth[:240] = 0
    image = DepthImage.pack(1, SECOND, "camera", depth, CAMERA, "16UC1")
    _, header, arrays = read(depth_picture(image, None))
    assert (header["width"], header["height"]) == (640, 480)
    assert arrays["u"].size == 0
    with Image.open(io.BytesIO(arrays["jpeg"].tobytes())) as picture:
        assert picture.size == (320, 240)
        pixels = np.asarray(picture).astype(int)
    assert pixels[20, 100].max() < 10  # no return
    assert pixels[220, 100].min() > 60


def test_depth_has_the_colours_of_the_project_s_pictures():
    depth = np.linspace(1, 4500, 50).astype(np.uint16)[None]
    ours = coloured(depth, 4.5)[0].astype(float)
    theirs = 255.0 * colormaps["cividis"](0.25 + 0.75 * depth[0] / 4500.0)[:, :3]
    assert np.abs(ours - theirs).max() < 10.0


def test_a_map_is_a_picture_of_three_values():
    grid = OccupancyGrid(
        stamp=SECOND, frame="map", resolution=0.05, width=3, height=2, origin=(-1.0, 0.5, 0.0),
        data=np.array([-1, 0, 100, 19, 50, 65], np.int8),
    )  # fmt: skip
    _, header, arrays = read(map_picture("fused", grid))
    assert (header["name"], header["resolution"], header["origin"]) == ("fused", 0.05, [-1.0, 0.5, 0.0])
    with Image.open(io.BytesIO(arrays["png"].tobytes())) as picture:
        assert np.asarray(picture).tolist() == [[2, 0, 1], [0, 2, 1]]
