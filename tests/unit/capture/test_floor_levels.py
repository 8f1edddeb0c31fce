"""Beside a kerb or on an uneven floor the tracker finds the robot's own level, or says that it does not know."""

import math
from dataclasses import replace

import numpy as np
import pytest

from cliffscan.common.contract.camera import FloorPlane, Region, axes, scan_axes
from cliffscan.services.capture.floor.tracker import FloorTracker
from cliffscan.simulator.kinect import KinectModel, measure
from cliffscan.simulator.sensor_models import MODELS
from cliffscan.simulator.sensors import SENSORS, sensor_camera
from tests import scenes

FRAMES = 4


def camera(height, pitch):
    return scenes.camera(320, 240, FloorPlane.from_mount(height, math.radians(pitch)), (0.2, 4.5))


def frames(eye, exact):
    """What a Kinect makes of exact millimetres."""
    rng = np.random.default_rng(3)
    inverse = np.divide(1000.0, exact, out=np.zeros(exact.shape), where=exact > 0).astype(np.float32)
    return [measure(inverse, eye, KinectModel(), rng) for _ in range(FRAMES)]


def track(eye, exact, mount):
    """The tracker after some frames from a camera that is said to be mounted so, and the last plane."""
    tracker = FloorTracker(mount)
    for depth in frames(eye, exact):
        found = tracker.update(depth, eye)
    return tracker, found


def is_right(found, true):
    tilts = [math.degrees(math.asin(np.dot(found[:3], axis))) for axis in axes(true)[:2]]
    return max(map(abs, tilts)) < 0.5 and abs(found.d - true.d) < 0.006


def kerb(eye, drop, right):
    """A street `drop` [m] lower on the robot's right, up to y = `right` [m]."""
    return scenes.depth(eye, holes=[(-9.0, -9.0, -drop, 20.0, right, 0.0)], wall=20.0)


@pytest.mark.parametrize(("height", "pitch"), [(0.3, 0), (0.5, 15), (0.8, 25)])
@pytest.mark.parametrize("drop", [0.06, 0.09, 0.12])
@pytest.mark.parametrize("right", [-0.05, 0.1, 0.2, 0.3])
def test_a_street_is_not_taken_for_the_pavement_from_a_mount_that_is_said_too_high(height, pitch, drop, right):
    eye, mount = camera(height, pitch), FloorPlane.from_mount(height + 0.035, math.radians(pitch))
    tracker, found = track(eye, kerb(eye, drop, right), mount)
    assert is_right(found, eye.floor) or found == mount
    assert tracker.note  # the street is not seen, the mount not known or wrong


def test_two_levels_of_which_either_may_be_the_mounts_are_told():
    eye = camera(0.3, 0)
    tracker, _ = track(eye, kerb(eye, 0.06, 0.0), FloorPlane.from_mount(0.335))
    assert tracker.note == "floor not seen, two levels 6 cm apart may be it: keeping the last plane"


@pytest.mark.parametrize("right", [-0.2, 0.0, 0.2])
def test_of_two_levels_the_one_that_is_clearly_the_mounts_is_the_floor(right):
    eye = camera(0.3, 0)
    tracker, found = track(eye, kerb(eye, 0.055, right), eye.floor)
    assert tracker.measured
    assert is_right(found, eye.floor)
    street = FloorPlane.from_mount(0.355)
    tracker, found = track(eye, kerb(eye, 0.055, right), street)
    assert tracker.measured
    assert is_right(found, street)


def uneven(eye, wave, length, edge, phase):
    """(rows, columns) [mm]: waves of `wave` and `length` [m] up to a step down of 12 cm at `edge` [m]."""
    forward, _, up = (axis.rows for axis in scan_axes(eye))
    z = np.linspace(0.2, 3.0, 4000)
    x = np.outer(forward, z)
    floor = np.where(x < edge, wave * np.sin(2 * np.pi * x / length + phase), -0.12 + 0.06 * (x - edge))
    met = np.outer(up, z) + eye.floor.d <= floor
    column = np.where(met.any(axis=1), 1000 * z[met.argmax(axis=1)], 0)
    return np.repeat(column[:, None], eye.width, axis=1).astype(np.uint16)


@pytest.mark.parametrize(
    "floor",
    [
        (0.006, 0.4, 0.65, 0.0),
        (0.006, 0.4, 1.0, 3.0),
        (0.006, 0.6, 1.0, 1.5),
        (0.008, 0.4, 0.65, 3.0),
        (0.008, 0.6, 0.8, 4.5),
        (0.010, 0.6, 0.8, 3.0),
    ],
)
def test_a_short_strip_of_an_uneven_floor_before_a_step_does_not_tilt_an_exact_mount(floor):
    eye = camera(0.7, 43)
    tracker, found = track(eye, uneven(eye, *floor), eye.floor)
    assert found == eye.floor
    assert "too uneven" in tracker.note


@pytest.mark.parametrize(("scale", "word", "share"), [(1.1, "lower", "10%"), (0.9, "higher", "10%")])
def test_a_scale_that_is_wrong_is_told_with_what_to_do(scale, word, share):
    eye = camera(0.4, 10)
    exact = scenes.depth(eye, wall=20.0)
    tracker, found = track(eye, (exact * scale).astype(np.uint16), eye.floor)
    assert tracker.measured
    assert found.d == pytest.approx(0.4 * scale, abs=0.004)
    assert tracker.note.startswith(f"the floor is 4 cm {word} than the mount has it: measure the mount with `cliffscan")
    assert tracker.note.endswith(f"the depth's scale is wrong by {share}")
    assert track(eye, exact, eye.floor)[0].note == ""


@pytest.mark.parametrize("name", SENSORS)
def test_the_floor_of_each_sensor_is_found_in_the_pixels_that_can_carry_a_return(name):
    whole = sensor_camera(name, 0.4, 0.3)
    last_row = whole.height - 60
    eye = replace(whole, seen=Region(0, 0, whole.width - 1, last_row))
    exact = scenes.depth(whole, wall=20.0)
    inverse = np.divide(1000.0, exact, out=np.zeros(exact.shape), where=exact > 0).astype(np.float32)
    depth = measure(inverse, whole, MODELS[name], np.random.default_rng(2))
    other = scenes.depth(replace(whole, floor=FloorPlane.from_mount(0.36, 0.3)), wall=20.0)
    depth[last_row + 1 :] = other[last_row + 1 :]
    tracker = FloorTracker(FloorPlane.from_mount(0.41, 0.32, 0.01))
    assert is_right(tracker.update(depth, eye), eye.floor)
    assert tracker.measured
