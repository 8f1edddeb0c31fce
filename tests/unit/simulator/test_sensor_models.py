"""Each kind of sensor errs as its kind does, and its camera says by how much."""

import math

import numpy as np
import pytest

from cliffscan.common.contract.camera import check_camera
from cliffscan.simulator.kinect import KinectModel, measure, returns
from cliffscan.simulator.sensor_models import MODELS
from cliffscan.simulator.sensors import SENSORS, sensor_camera
from cliffscan.simulator.stereo import StereoModel, window_means
from cliffscan.simulator.time_of_flight import TimeOfFlightModel

STEREO = ["d435", "d415"]
TIME_OF_FLIGHT = ["kinect_v2", "azure_kinect"]


def wall(name, depth):
    """What a sensor makes of a wall square to it, depth [m] away: (rows, columns) [mm]."""
    camera = sensor_camera(name)
    inverse = np.full((camera.height, camera.width), 1.0 / depth, np.float32)
    return measure(inverse, camera, MODELS[name], np.random.default_rng(1))


def deviation(name, depth):
    """Of the inverse depth [1/m] of the wall's middle."""
    seen = wall(name, depth)[50:-50, 50:-50]
    return float(np.std(1000.0 / seen[seen > 0]))


def test_each_sensor_has_a_model_and_a_possible_camera():
    assert set(MODELS) == set(SENSORS)
    for name, model in MODELS.items():
        camera = sensor_camera(name, 0.4, 0.2)
        check_camera(camera)
        assert camera.baseline == model.baseline


@pytest.mark.parametrize("name", ["kinect", *STEREO])
@pytest.mark.parametrize("depth", [1.0, 2.5])
def test_where_noise_is_constant_in_disparity_the_camera_has_it(name, depth):
    assert deviation(name, depth) == pytest.approx(SENSORS[name].noise, rel=0.12)


@pytest.mark.parametrize("name", TIME_OF_FLIGHT)
def test_noise_of_a_time_of_flight_camera_is_constant_in_depth_and_what_its_camera_has_at_a_metre(name):
    assert deviation(name, 1.0) == pytest.approx(SENSORS[name].noise, rel=0.05)
    near, far = (float(np.std(each[each > 0])) for each in (wall(name, 1.0), wall(name, 3.0)))
    assert near < far < 1.5 * near


@pytest.mark.parametrize("name", STEREO)
def test_stereo_errs_by_a_tenth_of_a_pixel(name):
    camera = sensor_camera(name)
    assert 0.08 <= camera.noise * camera.intrinsics.fx * camera.baseline <= 0.12


@pytest.mark.parametrize(
    ("name", "least", "most"), [("kinect", 0.0, 0.1), ("azure_kinect", 0.0, 0.1), ("d435", 0.8, 1.0)]
)
def test_neighbours_err_alike_in_stereo_alone(name, least, most):
    seen = wall(name, 2.0)[50:-50, 50:-50].astype(float)
    there = (seen[:, 1:] > 0) & (seen[:, :-1] > 0)
    together = np.corrcoef(seen[:, 1:][there], seen[:, :-1][there])[0, 1]
    assert least - 0.1 <= together <= most


def test_stereo_smears_an_edge_over_its_window_and_no_farther():
    model = StereoModel(noise=0.0, step=0.0, baseline=0.0, dropout=0.0, window=4)
    inverse = np.full((40, 60), 1.0, np.float32)
    inverse[:, 30:] = 0.5
    row = model.millimetres(inverse, (0.2, 6.0), np.random.default_rng(0))[20]
    assert (row[:26] == 1000).all()
    assert (row[34:] == 2000).all()
    assert (np.diff(row[25:35].astype(int)) > 0).all()


def test_stereo_sees_nothing_where_nothing_returns():
    model = MODELS["d435"]
    inverse = np.full((40, 60), 0.5, np.float32)
    inverse[10:20, 10:20] = 0.0
    seen = model.millimetres(inverse, (0.2, 6.0), np.random.default_rng(0))
    np.testing.assert_array_equal(seen > 0, inverse > 0)


@pytest.mark.parametrize("window", [0, 1, 3])
def test_window_means_are_those_of_each_window(window):
    values = np.random.default_rng(2).random((7, 9)).astype(np.float32)
    values[values < 0.3] = 0.0
    for v, u in np.ndindex(values.shape):
        part = values[max(v - window, 0) : v + window + 1, max(u - window, 0) : u + window + 1]
        expected = part[part > 0].mean() if (part > 0).any() else 0.0
        assert window_means(values, window)[v, u] == pytest.approx(expected, rel=1e-5)


@pytest.mark.parametrize("name", ["kinect_v2", "azure_kinect"])
def test_a_time_of_flight_camera_casts_no_shadow(name):
    camera = sensor_camera(name)
    depth = np.full((camera.height, camera.width), 3.0, np.float32)
    depth[100:200, 200:300] = 1.0
    assert (returns(depth, camera, MODELS[name]) > 0.0).all()


@pytest.mark.parametrize(
    "refused",
    [
        lambda: TimeOfFlightModel(noise=math.nan),
        lambda: StereoModel(noise=0.001, step=-1.0, baseline=0.05),
        lambda: KinectModel(dropout=1.0),
    ],
)
def test_a_model_that_means_nothing_is_refused(refused):
    with pytest.raises(ValueError, match="expected"):
        refused()
