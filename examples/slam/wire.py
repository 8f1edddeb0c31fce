"""The bytes on the network: msgpack maps, as the wire format describes them."""

import math
from dataclasses import dataclass
from typing import TypeGuard

import msgpack
import numpy as np
from numpy.typing import NDArray

from examples.slam.pose import Pose

FLOAT32, INT8 = np.dtype("<f4"), np.dtype("<i1")
Floats = NDArray[np.float32]
PLACE = ("x", "y", "yaw")
ABSENT = np.empty(0, np.float32)


class WireError(ValueError):
    """A sample is not what the wire format says; the text names what is wrong."""


@dataclass(frozen=True)
class Scan:
    """A LaserScan, as far as a map needs it."""

    stamp: int  # [ns]
    angle_min: float  # [rad] of the first beam
    angle_increment: float  # [rad]
    range_min: float  # [m]
    range_max: float  # [m]
    ranges: Floats  # (beams,) [m]: a number, +inf (looked, nothing there) or NaN (not seen)
    evidence: Floats  # (beams,): 0 nothing, 1 obstacle, 2 drop, ...; or (0,) where the scan has none
    clear: Floats  # (beams,) [m] up to which floor was seen; or (0,)

    @property
    def angles(self) -> NDArray[np.float64]:
        """(beams,) [rad]."""
        return self.angle_min + self.angle_increment * np.arange(len(self.ranges), dtype=np.float64)


@dataclass(frozen=True)
class Odometry:
    """Where the robot is by its wheels."""

    stamp: int  # [ns]
    pose: Pose


@dataclass(frozen=True)
class Camera:
    """Where a scan's origin is on the robot, and how near it sees floor."""

    place: Pose
    nearest_floor: float  # [m]


UNDESCRIBED = Camera(Pose(-0.087, 0.0, 0.0), 0.72)  # a TurtleBot 2's, until it is described


@dataclass(frozen=True)
class Map:
    """An occupancy grid; its cells go row by row from the lowest y, and in a row from the lowest x."""

    resolution: float  # [m] side of a cell
    x: float  # [m] lower left corner of the first cell
    y: float
    cells: NDArray[np.int8]  # (height, width): -1 unknown, 0 free ... 100 occupied


def read_scan(payload: bytes) -> Scan:
    """The scan in a LaserScan's bytes. Raises WireError."""
    fields = _map(payload)
    scan = Scan(
        stamp=_stamp(fields),
        angle_min=_number(fields, "angle_min"),
        angle_increment=_number(fields, "angle_increment"),
        range_min=_number(fields, "range_min"),
        range_max=_number(fields, "range_max"),
        ranges=_floats(fields, "ranges"),
        evidence=_floats(fields, "intensities"),
        clear=_floats(fields, "clear") if "clear" in fields else ABSENT,
    )
    beams = len(scan.ranges)
    if not beams or len(scan.evidence) not in (0, beams) or len(scan.clear) not in (0, beams):
        raise WireError(f"{beams} ranges with {len(scan.evidence)} intensities, {len(scan.clear)} clear")
    if not (np.isfinite(scan.clear) & (scan.clear >= 0.0)).all():
        raise WireError("clear: expected metres")
    return scan


def read_odometry(payload: bytes) -> Odometry:
    """The stamped pose in an Odometry's bytes. Raises WireError."""
    fields = _map(payload)
    pose = fields.get("pose")
    if not isinstance(pose, list) or len(pose) != 3 or not all(_is_number(each) for each in pose):
        raise WireError("pose: expected [x, y, theta]")
    return Odometry(_stamp(fields), Pose(*map(float, pose)))


def read_camera(payload: bytes) -> Camera | None:
    """The camera in a RobotDescription's bytes; None where they describe another part. Raises WireError."""
    camera = _map(payload).get("camera")
    if not isinstance(camera, dict):
        return None
    default = UNDESCRIBED.place
    place = (_number({name: value, **camera}, name) for name, value in zip(PLACE, default, strict=True))
    return Camera(Pose(*place), _number(camera, "nearest_floor"))


def write_map(grid: Map, stamp: int) -> bytes:
    """An OccupancyGrid's bytes, of the time `stamp` [ns]."""
    height, width = grid.cells.shape
    return _packed(
        stamp=stamp,
        frame="map",
        resolution=grid.resolution,
        width=width,
        height=height,
        origin=[grid.x, grid.y, 0.0],
        data=np.ascontiguousarray(grid.cells, INT8).tobytes(),
    )


def write_pose(pose: Pose, stamp: int) -> bytes:
    """A Pose2D's bytes: the robot on the map at the time `stamp` [ns]."""
    return _packed(stamp=stamp, frame="map", pose=list(pose))


def _packed(**fields: object) -> bytes:
    payload: bytes = msgpack.packb(fields)
    return payload


def _map(payload: bytes) -> dict[str, object]:
    try:
        fields = msgpack.unpackb(payload)
    except (ValueError, msgpack.UnpackException) as error:
        raise WireError(f"not msgpack: {error}") from error
    if not isinstance(fields, dict):
        raise WireError("expected a map")
    return fields


def _stamp(fields: dict[str, object]) -> int:
    stamp = fields.get("stamp")
    if not isinstance(stamp, int):
        raise WireError("stamp: expected nanoseconds")
    return stamp


def _is_number(value: object) -> TypeGuard[float]:
    return isinstance(value, int | float) and math.isfinite(value)


def _number(fields: dict[str, object], name: str) -> float:
    value = fields.get(name)
    if not _is_number(value):
        raise WireError(f"{name}: expected a number")
    return float(value)


def _floats(fields: dict[str, object], name: str) -> Floats:
    value = fields.get(name)
    if not isinstance(value, bytes) or len(value) % FLOAT32.itemsize:
        raise WireError(f"{name}: expected the bytes of float32")
    return np.frombuffer(value, FLOAT32)
