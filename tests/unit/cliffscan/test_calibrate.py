"""A mount is measured from frames of its floor; where there is none, one line says so."""

import math
import tomllib
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from cliffscan.calibrate import NotMeasured, measure
from cliffscan.common.contract.camera import KINECT_NOISE, FloorPlane
from cliffscan.common.contract.messages import DepthImage
from cliffscan.simulator.camera import SimulatedKinect
from cliffscan.simulator.sensor_models import MODELS
from cliffscan.simulator.sensors import SENSORS, sensor_camera
from tests import scenes

TRUE = (0.345, math.radians(12.3), math.radians(-1.4))
CAMERA = scenes.camera(320, 240, FloorPlane.from_mount(*TRUE), (0.5, 4.5))
NOMINAL = FloorPlane.from_mount(0.32, math.radians(10), 0.0)


def image(depth, camera=CAMERA):
    return DepthImage.decode(DepthImage.pack(0, 1, "camera", depth, replace(camera, floor=NOMINAL), "16UC1").encode())


FLOOR = image(scenes.depth(CAMERA, wall=20.0))
NOTHING = image(np.zeros((240, 320), np.uint16))


@pytest.mark.parametrize("nominal", [None, FloorPlane.from_mount(0.36, math.radians(15), 0.02)])
def test_the_lines_configure_the_mount_that_was_measured(nominal):
    told = measure(iter([FLOOR, NOTHING, FLOOR]), nominal).lines()
    table = tomllib.loads(told)["capture"]
    assert table["height"] == pytest.approx(0.345, abs=1e-3)
    assert table["pitch"] == pytest.approx(12.3, abs=0.05)
    assert table["roll"] == pytest.approx(-1.4, abs=0.05)
    assert "floor seen in 2 of 3 frames" in told
    assert "residual" in told
    assert "scatter" in told


@pytest.mark.parametrize("name", SENSORS)
@pytest.mark.parametrize(("height", "pitch"), [(0.3, 0.0), (0.8, 0.4)])
def test_the_noise_of_a_sensor_is_measured_on_the_floor(name, height, pitch):
    eye = sensor_camera(name, height, pitch)
    sensor = SimulatedKinect("open_floor", eye, MODELS[name], seed=1)
    kinect = replace(eye, noise=KINECT_NOISE)  # as a camera that nobody configured has it
    frames = (DepthImage.pack(0, 1, "camera", sensor.frame(), kinect, "16UC1") for _ in range(2))
    found = measure(frames, None)
    table = tomllib.loads(found.lines())["capture"]
    assert table["noise"] == pytest.approx(found.noise.whole, abs=1e-5)
    if eye.baseline:  # its noise is constant in the inverse depth
        assert found.noise == pytest.approx([eye.noise] * 3, rel=0.15)
    else:
        assert found.noise.far < found.noise.whole < found.noise.near < 2.5 * eye.noise


@pytest.mark.parametrize("last_row", [239, 230])
def test_the_region_is_measured_on_a_floor_that_a_person_vouches_for(last_row):
    depth = scenes.depth(CAMERA, wall=20.0)
    depth[last_row + 1 :] = 0
    told = measure(iter([image(depth)] * 2), None).lines()
    assert tomllib.loads(told)["capture"].get("region", [0, 0, 319, 239]) == [0, 0, 319, last_row]


@pytest.mark.parametrize(
    ("images", "why"),
    [
        ([NOTHING], "floor seen in 0 of 1 frames: floor not seen, nearly no depth"),
        ([FLOOR, NOTHING, NOTHING], "floor seen in 1 of 3 frames"),
        ([], "floor seen in 0 of 0 frames"),
    ],
)
def test_a_floor_that_is_not_seen_is_no_mount(images, why):
    with pytest.raises(NotMeasured, match=why) as refused:
        measure(iter(images), None)
    assert "\n" not in str(refused.value)


def test_a_robot_that_moves_is_not_measured():
    nodding = [
        replace(CAMERA, floor=FloorPlane.from_mount(TRUE[0], TRUE[1] + math.radians(nod))) for nod in (-1.5, 0.0, 1.5)
    ]
    with pytest.raises(NotMeasured, match="the floor moved"):
        measure((image(scenes.depth(camera, wall=20.0), camera) for camera in nodding), None)


@given(st.floats(0.05, 20), st.floats(-1.5, 1.5), st.floats(-3.1, 3.1))
def test_a_floor_tells_the_mount_it_was_made_of(height, pitch, roll):
    assert FloorPlane.from_mount(height, pitch, roll).mount() == pytest.approx((height, pitch, roll), abs=1e-6)
