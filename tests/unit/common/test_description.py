"""What is told of a camera is what its pixels see, for any mount: every pixel's ray is followed to the floor."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from cliffscan.common.contract.camera import FloorPlane, scan_axes
from cliffscan.common.contract.description import CameraDescription, Place, RobotDescription, check_place
from cliffscan.common.contract.message import MessageError
from tests import build

UPWARD, DOWN, SIDEWAYS = math.radians(-40), math.radians(40), math.pi / 2

heights = st.floats(0.05, 3.0)
pitches = st.floats(-1.5, 1.5)
rolls = st.one_of(st.floats(-math.pi, math.pi), st.sampled_from([0.0, SIDEWAYS, -SIDEWAYS, math.pi, -math.pi]))
centres = st.tuples(st.floats(-64, 128), st.floats(-48, 96))
nears, fars = st.floats(0.0, 2.0), st.floats(2.1, 20.0)


def describe(camera):
    return CameraDescription.of(camera, "eye", simulated=False)


def floor_pixels(camera):
    """Each floor pixel ahead within range: azimuth [rad] and horizontal distance [m], both (n,)."""
    forward, left, up = (axis.table() for axis in scan_axes(camera))
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        depth = np.where(up < 0.0, -camera.floor.d / up, np.inf)
    near, far = camera.range
    seen = (near <= depth) & (depth <= far) & (forward >= 0.0)
    return np.arctan2(left, forward)[seen], depth[seen] * np.hypot(forward, left)[seen]


def test_a_level_kinect_sees_floor_from_the_last_row_on():
    camera = build.camera(640, 480, 575.8, mount=(0.3, 0, 0), centre=(314.5, 235.5))
    told = describe(camera)
    assert told.nearest_floor == pytest.approx(0.3 * 575.8 / (479 - 235.5))
    assert told.field_of_view == pytest.approx((-math.atan(324.5 / 575.8), math.atan(314.5 / 575.8)))
    assert told.farthest == pytest.approx(4.5 * math.hypot(1, 324.5 / 575.8))
    assert (told.frame, told.simulated) == ("eye", False)


def test_a_camera_upside_down_sees_floor_from_its_first_row_on():
    told = describe(build.camera(640, 480, 500.0, mount=(0.3, 0, math.pi), centre=(300, 200)))
    assert told.nearest_floor == pytest.approx(0.3 * 500 / 200)


@pytest.mark.parametrize(("roll", "pixels"), [(SIDEWAYS, 339), (-SIDEWAYS, 300)])
def test_a_camera_on_its_side_sees_floor_from_its_outermost_column_on(roll, pixels):
    told = describe(build.camera(640, 480, 500.0, mount=(0.3, 0, roll), reach=(0.1, 4.5), centre=(300, 240)))
    assert told.nearest_floor == pytest.approx(0.3 * 500 / pixels)


def test_floor_nearer_than_the_sensor_measures_is_not_seen():
    told = describe(build.camera(640, 480, 500.0, mount=(0.3, DOWN, 0), reach=(0.5, 4.5)))
    slope = 0.3 / 0.5  # of the first floor measured: below the optical axis by as much for each metre of depth
    below_axis = (slope - math.sin(DOWN)) / math.cos(DOWN)
    assert told.nearest_floor == pytest.approx(0.5 * (math.cos(DOWN) - below_axis * math.sin(DOWN)))


@pytest.mark.parametrize("place", [Place(5.0, -5.0, 2 * math.pi), Place(-5.0, 5.0, -2 * math.pi)])
def test_a_place_on_a_base_can_be_told(place):
    check_place(place)
    told = CameraDescription.of(build.camera(), "eye", False, place)
    assert (told.x, told.y, told.yaw) == place


@pytest.mark.parametrize("wrong", [math.nan, math.inf, -math.inf, 6.3, -1e9])
@pytest.mark.parametrize("field", Place._fields)
def test_a_place_where_no_camera_stands_is_refused_by_its_field(field, wrong):
    with pytest.raises(ValueError, match=f"place: {field} of .* is impossible"):
        check_place(Place(0.0, 0.0, 0.0)._replace(**{field: wrong}))


def test_a_camera_that_sees_no_floor_says_so():
    told = describe(build.camera(mount=(0.3, UPWARD, 0)))
    assert told.nearest_floor == told.farthest
    assert told.field_of_view == (0.0, 0.0)


def test_floor_right_below_the_camera_is_nowhere_nearer_than_that():
    """Rounded, the ray that goes straight down goes back by a hair."""
    assert describe(build.camera(mount=(1.0, 1.09375, 0.0), centre=(63.0, 2.0))).nearest_floor == 0.0


def test_a_camera_that_looks_past_what_is_ahead_sees_no_floor_there():
    told = describe(build.camera(centre=(-64, 24)))
    assert told.nearest_floor == told.farthest
    assert told.field_of_view[1] < 0.0


@given(heights, pitches, rolls, centres, nears, fars)
def test_the_field_of_view_and_the_nearest_floor_are_those_of_the_pixels(height, pitch, roll, centre, near, far):
    camera = build.camera(64, 48, 58.0, (height, pitch, roll), (near, far), centre)
    told = describe(camera)
    azimuths, distances = floor_pixels(camera)
    assert 0.0 <= told.nearest_floor <= told.farthest
    assert -math.pi / 2 <= told.field_of_view[0] <= told.field_of_view[1] <= math.pi / 2
    if len(azimuths):
        assert told.field_of_view[0] <= azimuths.min() + 1e-9
        assert azimuths.max() <= told.field_of_view[1] + 1e-9
        assert distances.max() <= told.farthest * (1 + 1e-9)


@settings(max_examples=25)  # of half a million pixels each
@given(heights, st.floats(-0.3, 1.0), rolls, st.floats(0.5, 6.0))
def test_many_pixels_come_as_near_as_is_told(height, pitch, roll, far):
    """With more pixels the least distance straight ahead, and the outermost azimuths, come out as told."""
    camera = build.camera(800, 600, 725.0, (height, pitch, roll), (0.3, far))
    told = describe(camera)
    azimuths, distances = floor_pixels(camera)
    assume(len(azimuths) > 1000)
    assert told.field_of_view == pytest.approx((azimuths.min(), azimuths.max()), abs=0.02)
    ahead = np.abs(azimuths) < 2e-3
    if ahead.any():
        assert told.nearest_floor == pytest.approx(distances[ahead].min(), rel=0.01, abs=0.01)


@given(heights, st.floats(-1.5, 1.5), rolls, centres)
def test_a_mirrored_camera_sees_the_mirrored_floor(height, pitch, roll, centre):
    camera = build.camera(mount=(height, pitch, roll), centre=centre)
    mirrored = build.camera(mount=(height, pitch, -roll), centre=(63 - centre[0], centre[1]))
    told, other = describe(camera), describe(mirrored)
    assert other.nearest_floor == pytest.approx(told.nearest_floor, abs=1e-6)
    assert other.field_of_view == pytest.approx((-told.field_of_view[1], -told.field_of_view[0]), abs=1e-6)


@pytest.mark.parametrize(("near", "far"), [(0.0, 0.001), (0.5, 1000.0)])
def test_the_oddest_camera_has_a_description(near, far):
    camera = build.camera(2, 2, 0.2, (20.0, 1.51, 3.0), (near, far), (4, -2))
    assert CameraDescription.model_validate(describe(camera).model_dump()) == describe(camera)


def test_a_description_travels():
    sent = RobotDescription(stamp=5, camera=describe(build.camera()))
    assert RobotDescription.decode(sent.encode()) == sent
    assert RobotDescription.schema_name() == "cliffscan.RobotDescription.v1"


@pytest.mark.parametrize(
    ("field", "value"),
    [
        ("nearest_floor", -0.1),
        ("nearest_floor", math.inf),
        ("farthest", "4.5"),
        ("field_of_view", [0.5]),
        ("field_of_view", [math.nan, 0.5]),
        ("simulated", 1),
        ("frame", "x" * 257),
    ],
)
def test_a_malformed_description_is_refused_by_its_field(field, value):
    camera = describe(build.camera()).model_dump() | {field: value}
    with pytest.raises(MessageError, match=rf"camera\.{field}"):
        RobotDescription.decode(build.payload({"stamp": 5, "camera": camera}))


def test_a_floor_of_an_imprecise_normal_is_the_same_floor():
    camera = build.camera(mount=(0.3, 0.2, 0.1))
    long = replace(camera, floor=FloorPlane(*(1.005 * each for each in camera.floor[:3]), camera.floor.d))
    assert describe(long).nearest_floor == pytest.approx(describe(camera).nearest_floor)
