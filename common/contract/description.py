"""What is true of a robot: published once by the process that knows it, and taken from there by all others."""

import math
from typing import Annotated, NamedTuple, Self

import numpy as np
from pydantic import Field

from cliffscan.common.contract import limits
from cliffscan.common.contract.camera import KINECT_BASELINE, KINECT_NOISE, Camera, reach
from cliffscan.common.contract.floor_view import floor_in_view, straight_ahead
from cliffscan.common.contract.message import ListAsTuple, Message, Part, Stamp

Metres = Annotated[float, Field(ge=0, le=1e5)]
Coordinate = Annotated[float, limits.COORDINATE]
Angle = Annotated[float, limits.HEADING]
Pair = Annotated[tuple[float, float], ListAsTuple]
Point = Annotated[tuple[Coordinate, Coordinate], ListAsTuple]
MOST_CORNERS = 16  # of a polygon
Polygon = Annotated[tuple[Point, ...], ListAsTuple, Field(max_length=MOST_CORNERS)]


class Place(NamedTuple):
    """Where a camera stands on the base: the point of the floor below it, seen from the middle between the wheels."""

    x: float  # [m] ahead
    y: float  # [m] to the left
    yaw: float  # [rad] by which the camera looks to the left


def check_place(place: Place) -> None:
    """Raise ValueError where no camera stands so on a base."""
    for name, distance in (("x", place.x), ("y", place.y)):
        if not abs(distance) <= limits.FARTHEST_PLACE:  # nor for NaN
            most = f"{limits.FARTHEST_PLACE:g} m"
            raise ValueError(f"place: {name} of {distance:g} m is impossible, expected {most} to either side at most")
    if not abs(place.yaw) <= 2 * math.pi:
        raise ValueError(f"place: yaw of {place.yaw:g} rad is impossible, expected one turn at most; is it in degrees?")


TURTLEBOT_2 = Place(x=-0.087, y=0.0, yaw=0.0)  # its Kinect stands behind


class CameraDescription(Part):
    """What the camera can see of the floor from its nominal mount, in the scan frame: see contract/camera."""

    frame: Annotated[str, Field(max_length=256)]  # of the depth images
    simulated: bool  # whether its pictures are of a simulated or a recorded world
    nearest_floor: Metres  # [m] from the point below the camera straight ahead to the first floor it sees there
    farthest: Metres  # [m] horizontally, at most, to anything it measures
    field_of_view: Pair  # [rad] rightmost and leftmost azimuth at which it sees floor ahead
    x: Coordinate = TURTLEBOT_2.x  # [m] where it stands on the base
    y: Coordinate = TURTLEBOT_2.y
    yaw: Angle = TURTLEBOT_2.yaw  # [rad]
    height: Metres | None = None  # [m] above the floor
    pitch: Angle | None = None  # [rad] it looks down
    roll: Angle | None = None  # [rad] it leans to its right
    noise: Annotated[float, Field(ge=0, le=1)] = KINECT_NOISE  # [1/m] standard deviation of its inverse depth
    baseline: Annotated[float, Field(ge=0, le=10)] = KINECT_BASELINE  # [m] between its two eyes
    visible_floor: Polygon = ()  # [m] corners x, y of the floor in view, convex, from the point below the camera

    @classmethod
    def of(
        cls,
        camera: Camera,
        frame: str,
        simulated: bool,
        place: Place = TURTLEBOT_2,
    ) -> Self:
        """The description of a possible camera over an endless floor without anything on it.

        `nearest_floor` is `farthest` where no floor is seen straight ahead, the field of view (0, 0) where none is.
        """
        floor = floor_in_view(camera)
        farthest = reach(camera)
        ahead = straight_ahead(floor)
        azimuths = np.arctan2(floor[:, 1], floor[:, 0])
        corners = camera.floor.d * floor[:, :2] / -floor[:, 2:]
        height, pitch, roll = camera.floor.mount()
        return cls(
            frame=frame,
            simulated=simulated,
            **place._asdict(),
            height=height,
            pitch=pitch,
            roll=roll,
            noise=camera.noise,
            baseline=camera.baseline,
            visible_floor=tuple((float(x), float(y)) for x, y in corners),
            nearest_floor=max(float((camera.floor.d * ahead[:, 0] / -ahead[:, 2]).min(initial=farthest)), 0.0),
            farthest=farthest,
            field_of_view=(float(azimuths.min()), float(azimuths.max())) if len(floor) else (0.0, 0.0),
        )


class BodyDescription(Part):
    """What moves: a disc around the middle between the wheels, or the polygon of the footprint in it."""

    simulated: bool  # whether its port leads to an emulated base
    radius: Metres  # [m]
    footprint: Polygon = ()  # [m] corners x, y, in order, convex or not
    height: Metres | None = None  # [m] what is higher the robot passes under


class RobotDescription(Message):
    """One process's part of the description: `camera` comes from capture, `body` from the base's service."""

    stamp: Stamp
    camera: CameraDescription | None = None
    body: BodyDescription | None = None
