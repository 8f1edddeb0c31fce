"""The scanning services answer a foreign client's raw frames: as the paper has it, and as they do by default."""

import math

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cliffscan.common.contract.beam_grid import Grid
from cliffscan.common.contract.camera import FloorPlane
from tests import naive, naive_positive, scenes
from tests.service.conftest import image, intensities, ranges

GRID = Grid.between(64, -math.radians(29), math.radians(29))
BAND, ROBOT = 0.03, 0.42
SCANS = {
    "scan/positive": "cliffscan.LaserScan.v1",
    "scan/negative/farthest_point": "cliffscan.LaserScan.v1",
    "scan/negative/virtual_floor": "cliffscan.LaserScan.v1",
    "scan/negative": "cliffscan.LaserScan.v1",
    "scan/fused": "cliffscan.LaserScan.v1",
}
CAMERAS = [
    scenes.camera(),
    scenes.camera(floor=FloorPlane.from_mount(0.45, math.radians(20))),
    scenes.camera(48, 36, FloorPlane.from_mount(0.3, math.radians(-3), math.radians(8))),
]


@pytest.fixture
def services(start):
    for service in ("negative", "positive"):
        start(service, "--set", f"scan.beams={GRID.beams}", "--set", "profile=paper", wait=False)
    start("fuse", wait=False)


@pytest.fixture
def ears(client, services):
    for service in ("negative", "positive", "fuse"):
        client.wait_alive(service)
    return {path: client.listen(path) for path in SCANS}


def expected(depth, camera):
    """Each scan as the slow transcription has it."""
    farthest = naive.farthest_point(depth, camera, GRID, BAND)
    virtual = naive.virtual_floor(depth, camera, GRID, BAND)
    positive = naive_positive.projection(depth, camera, GRID, BAND, ROBOT)
    negative = naive.combine(farthest, virtual)
    everything = (positive, farthest, virtual, negative, naive.combine(positive, negative))
    return dict(zip(SCANS, everything, strict=True))


def test_every_scene_gives_the_papers_scans(client, ears):
    frames = [(camera, scenes.depth(camera, **scene)) for camera in CAMERAS for scene in scenes.SCENES.values()]
    for number, (camera, depth) in enumerate(frames):
        stamp = 1_000 + number
        client.put("camera/depth", image(camera, depth, stamp, seq=number))
        for path, right in expected(depth, camera).items():
            scan = ears[path].get()
            assert (scan["seq"], scan["stamp"]) == (number, stamp), path
            assert_allclose(ranges(scan), right, rtol=1e-5, err_msg=path)


def test_scans_keep_the_contract(client, ears):
    camera = CAMERAS[0]
    client.put("camera/depth", image(camera, scenes.depth(camera, [scenes.HOLE]), 5))
    for path, ear in ears.items():
        scan = ear.get()
        assert scan["angle_min"] == pytest.approx(-math.radians(29))
        assert scan["angle_max"] == pytest.approx(scan["angle_min"] + 63 * scan["angle_increment"])
        assert len(ranges(scan)) == len(intensities(scan)) == 64
        numbers = np.isfinite(ranges(scan))
        assert numbers.any()
        assert (ranges(scan)[numbers] <= scan["range_max"]).all()
        kinds = set(intensities(scan)[numbers])
        assert kinds <= {"positive": {1}, "fused": {1, 2, 4}, "negative": {2, 4}}.get(path.rpartition("/")[2], {2, 4})
        assert not intensities(scan)[~numbers].any()
    client.put("camera/depth", image(camera, scenes.depth(camera), 6))
    for path, ear in ears.items():
        assert ear.encoding() == f"application/msgpack;{SCANS[path]}"


@pytest.fixture
def negative(client, start):
    start("negative", "--set", "scan.beams=160")


def test_by_default_negative_is_near_edge(client, negative):
    near, combined = client.listen("scan/negative/near_edge"), client.listen("scan/negative")
    paper = [client.listen(f"scan/negative/{method}") for method in ("farthest_point", "virtual_floor")]
    camera = scenes.camera(160, 120, FloorPlane.from_mount(0.3, math.radians(12)))
    client.put("camera/depth", image(camera, scenes.depth(camera, [scenes.HOLE]), 5))
    one, other = near.get(), combined.get()
    assert one["ranges"] == other["ranges"]
    assert one["intensities"] == other["intensities"]
    on_hole = np.abs(np.tan(np.radians(np.linspace(-29, 29, 160))) * scenes.HOLE[0]) < 0.3
    assert_allclose(ranges(one)[on_hole] * np.cos(np.radians(np.linspace(-29, 29, 160)))[on_hole], 1.5, atol=0.06)
    assert set(intensities(one)[on_hole]) == {2}
    farthest_point, virtual_floor = (ranges(ear.get()) for ear in paper)  # published for those who listen
    assert np.isfinite(farthest_point).all()
    assert (ranges(other)[on_hole] < virtual_floor[on_hole]).all()
