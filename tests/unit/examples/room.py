"""A made-up place of straight lines, a drive through it, and what scanner and wheels would say; no simulator."""

import math

import msgpack
import numpy as np

from examples.slam.pose import Pose

SECOND = 1_000_000_000  # [ns]
START = 1_700_000_000 * SECOND
OBSTACLE, DROP = 1.0, 2.0
HALF_VIEW = math.radians(29)
RANGE_MAX = 4.5
CAMERA = Pose(-0.087, 0.0, 0.0)


def box(left, bottom, right, top):
    """The four sides of a rectangle, as (4, 4) x1, y1, x2, y2 [m]."""
    corners = [(left, bottom), (right, bottom), (right, top), (left, top)]
    return np.array([(*a, *b) for a, b in zip(corners, corners[1:] + corners[:1], strict=True)])


class Room:
    """Lines that beams end on, each with its evidence."""

    def __init__(self, walls, edges=()) -> None:
        """`walls` and `edges`: (lines, 4) x1, y1, x2, y2 [m]; an edge is where the floor ends."""
        edges = np.reshape(edges, (-1, 4))
        self._lines = np.concatenate([walls, edges])
        self._evidence = np.repeat([OBSTACLE, DROP], [len(walls), len(edges)])

    def look(self, pose, angles):
        """Range [m], +inf where nothing is near enough, and evidence of beams at `angles` from `pose`."""
        x1, y1, x2, y2 = self._lines.T
        cos, sin = np.cos(angles + pose.theta)[:, None], np.sin(angles + pose.theta)[:, None]
        across = cos * (y2 - y1) - sin * (x2 - x1)
        with np.errstate(divide="ignore", invalid="ignore"):
            along = ((x1 - pose.x) * (y2 - y1) - (y1 - pose.y) * (x2 - x1)) / across
            share = ((x1 - pose.x) * sin - (y1 - pose.y) * cos) / across
        met = (along > 0) & (share >= 0) & (share <= 1) & (along <= RANGE_MAX)
        ranges = np.where(met, along, math.inf)
        nearest = ranges.argmin(axis=1)
        ranges = ranges[np.arange(len(ranges)), nearest]
        return ranges, np.where(np.isfinite(ranges), self._evidence[nearest], 0.0)

    def distance(self, x, y):
        """Distance [m] of each point from the nearest line."""
        x1, y1, x2, y2 = self._lines.T
        x, y = np.asarray(x)[:, None], np.asarray(y)[:, None]
        share = ((x - x1) * (x2 - x1) + (y - y1) * (y2 - y1)) / ((x2 - x1) ** 2 + (y2 - y1) ** 2)
        share = np.clip(share, 0, 1)
        return np.hypot(x - x1 - share * (x2 - x1), y - y1 - share * (y2 - y1)).min(axis=1)

    def scan(self, robot, stamp, beams=160):
        """The LaserScan, in plain types, of a camera on a robot at a pose."""
        angles = np.linspace(-HALF_VIEW, HALF_VIEW, beams)
        return scan_fields(*self.look(robot.then(CAMERA), angles), stamp)


def scan_fields(ranges, evidence, stamp=START):
    """A LaserScan of these beams, in plain types."""
    return {
        "seq": 1,
        "stamp": stamp,
        "frame": "camera_footprint",
        "angle_min": -HALF_VIEW,
        "angle_max": HALF_VIEW,
        "angle_increment": 2 * HALF_VIEW / max(len(ranges) - 1, 1),
        "time_increment": 0.0,
        "scan_time": 0.033,
        "range_min": 0.0,
        "range_max": RANGE_MAX,
        "ranges": np.asarray(ranges, "<f4").tobytes(),
        "intensities": np.asarray(evidence, "<f4").tobytes(),
    }


def odometry_fields(pose, stamp=START):
    """An Odometry, in plain types."""
    return {
        "stamp": stamp,
        "frame": "odom",
        "child_frame": "base_link",
        "pose": list(pose),
        "twist": [0.2, 0.0],
        "pose_covariance": [0.0] * 9,
        "twist_covariance": [0.0] * 9,
    }


def payload(fields):
    """The bytes that a client with nothing but msgpack sends."""
    return msgpack.packb(fields)


ROOM = Room(
    np.concatenate([box(-3, -3, 3, 3), box(-0.4, -0.3, 0.5, 0.4), box(2.0, 0.8, 3.0, 1.3), box(-3, 1.9, -2.2, 3)])
)


def lap(radius=1.6, spacing=0.1):
    """Poses of a robot that drives once, and a little more, around the middle of the room."""
    count = round(2.2 * math.pi * radius / spacing)
    for number in range(count):
        turned = number * spacing / radius
        yield Pose(radius * math.sin(turned), -radius * math.cos(turned), math.remainder(turned, math.tau))


def drifting(poses, stretch=1.03, turn=1.04):
    """The same drive as wheels tell it that slip a little: steps too long, turns too wide."""
    last = told = None
    for pose in poses:
        step = last.step_to(pose) if last else Pose()
        told = told.then(Pose(step.x * stretch, step.y * stretch, step.theta * turn)) if last else pose
        last = pose
        yield told
