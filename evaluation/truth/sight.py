"""What a Kinect can see of the floor: within its image and range, not too grazing, not hidden and not in shadow."""

import math

import numpy as np

from cliffscan.common.contract.camera import Camera, Floats
from cliffscan.simulator.kinect import KinectModel
from evaluation.scenes.mounts import ROLL, pose, upright
from evaluation.scenes.polygons import crossing
from evaluation.scenes.scene import Ramp, Scene
from evaluation.truth.beam_truth import Mask

SENSOR = KinectModel()
SURE = 1.05  # times the sine of the least angle: the sensor's own estimate of it errs by a few per cent
GRAZING = SURE * SENSOR.grazing
SLACK = 1e-6  # [px] so that the outermost beams, which graze the image's border, are within it
STEP = 1e-3  # [m] over which the spacing of rows is taken
ROWS_BEFORE = 3  # rows of floor that must be seen before an edge
LEANS = math.radians(1.01 * ROLL)  # beyond, a line along the floor may leave the image by its sides
GLANCE, WITHIN, SAMPLE = 0.20, 3.0, 0.05  # [m] of floor that is enough to be asked for it, up to that distance


def floor_points(angles: Floats, distance: Floats) -> Floats:
    """The points of the floor at a distance [m] along each beam: (n, 3); far away for inf."""
    near = np.minimum(distance, 1e3)
    return np.column_stack([near * np.cos(angles), near * np.sin(angles), np.zeros(len(angles))])


def pixels(camera: Camera, points: Floats) -> tuple[Floats, Floats, Floats]:
    """Column, row [px] and depth [m] of points (n, 3) of the scan frame: three of (n,); NaN behind the camera."""
    position, rotation = pose(camera)
    x, y, z = ((points - position) @ rotation).T
    fx, fy, cx, cy = camera.intrinsics
    z = np.where(z > 0.0, z, math.nan)
    return cx + fx * x / z, cy + fy * y / z, z


def measurable(camera: Camera, angles: Floats, distances: Floats) -> Mask:
    """Whether floor at these azimuths [rad] and distances [m] is within the camera's image and range: (n,)."""
    column, row, depth = pixels(camera, floor_points(angles, distances))
    near, far = camera.range
    left, top, right, bottom = camera.region
    within = (np.abs(column - (left + right) / 2) <= (right + 1 - left) / 2 + SLACK) & (depth >= near) & (depth <= far)
    seen: Mask = within & (np.abs(row - (top + bottom) / 2) <= (bottom + 1 - top) / 2)
    return seen


def floor_in_sight(camera: Camera, angles: Floats) -> Mask:
    """Whether GLANCE of floor is in the camera's image and range along a beam, all within WITHIN: (n,)."""
    distances = np.arange(SAMPLE, WITHIN + SAMPLE / 2, SAMPLE)
    along, at = np.repeat(angles, len(distances)), np.tile(distances, len(angles))
    seen = measurable(camera, along, at).reshape(len(angles), -1)
    stretch = np.lib.stride_tricks.sliding_window_view(seen, round(GLANCE / SAMPLE) + 1, axis=1)
    glanced: Mask = np.any(np.all(stretch, axis=2), axis=1)
    return glanced


def row_spacing(camera: Camera, angles: Floats, distance: Floats) -> Floats:
    """How much farther ahead the next row's floor lies [m]: (n,); for a level camera z² / (f h).

    The rows are those of the image as it is nearest to upright.
    """
    camera = upright(camera)
    finite = np.where(np.isfinite(distance), distance, 1.0)
    points = floor_points(angles, finite)
    _, here, _ = pixels(camera, points)
    _, there, _ = pixels(camera, points + np.array([STEP, 0.0, 0.0]))
    return np.where(np.isfinite(distance), np.nan_to_num(STEP / np.maximum(here - there, 1e-9), nan=1e3), 0.0)


def in_view(camera: Camera, angles: Floats, edge: Floats, beyond: float) -> Mask:
    """Whether the sensor measures floor right up to an edge, and sees what is `beyond` [m] it: (n,)."""
    camera = upright(camera)
    first_column, first_row, last_column, last_row = camera.region
    half, middle = (last_column + 1 - first_column) / 2, (first_column + last_column) / 2
    points = floor_points(angles, edge)
    column, row, depth = pixels(camera, points)
    aside, top, _ = pixels(camera, floor_points(angles, edge + beyond))
    sine = camera.floor.d / np.hypot(np.hypot(points[:, 0], points[:, 1]), camera.floor.d)
    in_image = (np.abs(column - middle) <= half) & (top >= first_row)
    in_image &= row <= last_row - ROWS_BEFORE
    if abs(camera.floor.mount()[2]) > LEANS:
        before, _, _ = pixels(camera, floor_points(angles, edge - ROWS_BEFORE * row_spacing(camera, angles, edge)))
        in_image &= (np.abs(aside - middle) <= half) & (np.abs(before - middle) <= half)
    near, far = camera.range
    seen: Mask = in_image & (depth >= near + 0.01) & (depth <= far) & (sine >= GRAZING)
    return seen


def unobstructed(scene: Scene, camera: Camera, angles: Floats, edge: Floats) -> Mask:
    """Whether both the camera and the projector see the floor at the edge: (n,)."""
    position, rotation = pose(camera)
    projector = position + rotation[:, 0] * camera.baseline
    targets = floor_points(angles, edge)
    clear = np.ones(len(angles), dtype=bool)
    for eye in (position, projector):
        for piece in scene.obstacles:
            enter, leave = crossing(piece.outline, eye[:2], targets[:, :2] - eye[:2])
            enter, leave = np.clip(enter, 0.0, 1.0), np.clip(leave, 0.0, 1.0 - 1e-6)
            within = (eye[2] * (1.0 - enter) >= piece.bottom) & (eye[2] * (1.0 - leave) <= piece.top)
            clear &= ~((enter < leave) & within)
    return clear


def lost_from(ramp: Ramp | None, camera: Camera, angles: Floats, grazing: float) -> tuple[Floats, Floats]:
    """Distance [m] at which a ramp, or the floor behind it, goes out of the sensor's sight, and how much of it is seen.

    Two of (n,): inf where it stays in sight as far as the sensor reaches; the stretch [m] from the ramp's start on.
    Out of sight is what is seen at an angle whose sine is below `grazing`. On a flat face that sine is the camera's
    height above the face's plane over the distance of the point, so it is lost from one distance on.
    """
    lost = np.full(len(angles), math.inf)
    if ramp is None:
        return lost, lost
    along = np.cos(angles - ramp.heading)
    end = ramp.start + ramp.length
    for start, stop, slope in ((ramp.start, end, ramp.slope), (end, math.inf, 0.0)):
        base = ramp.slope * (start - ramp.start)  # height of the floor where the face starts
        gone = np.maximum(start / along, in_sight(camera.floor.d, base, slope, start, along, grazing))
        lost = np.where((gone < stop / along) & (gone < lost), gone, lost)
    _, _, depth = pixels(camera, floor_points(angles, lost))
    return np.where(depth <= camera.range[1], lost, math.inf), lost - ramp.start / along


def in_sight(height: float, base: float, slope: float, start: float, along: Floats, grazing: float) -> Floats:
    """How far [m] along each beam the sensor sees a face: (n,), 0 = not at all.

    The face rises by `slope` from `base` [m], at `start` [m] ahead; the camera is `height` [m] above the floor. Solves
    |p - camera| = above / grazing, above being its height over the face's plane, for the distance s of
    p = (s, base + slope (s along - start)).
    """
    offset = base - slope * start - height
    above = -offset / math.hypot(1.0, slope)
    if above <= 0.0:
        return np.zeros(len(along))
    rise = slope * along
    a, b, c = 1.0 + rise**2, rise * offset, offset**2 - (above / grazing) ** 2
    return np.asarray((-b + np.sqrt(np.maximum(b * b - a * c, 0.0))) / a)
