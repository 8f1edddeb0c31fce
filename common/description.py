"""What is true of a robot: said once by the process that knows it, and taken from there by all others."""

from __future__ import annotations

from typing import Annotated, Self

import numpy as np
from pydantic import Field

from common.geometry import Camera, scan_axes
from common.message import ListAsTuple, Message, Part, Stamp

Metres = Annotated[float, Field(ge=0, le=1e5)]
Azimuths = Annotated[tuple[float, float], ListAsTuple]


class CameraDescription(Part):
    """What the camera can see of the floor at its nominal mount, in the scan frame."""

    frame: Annotated[str, Field(max_length=256)]  # of the depth images
    simulated: bool  # whether its pictures are of a simulated or a recorded world
    nearest_floor: Metres  # [m] horizontally from the camera along its axis
    farthest: Metres  # [m] horizontal reach of the sensor
    field_of_view: Azimuths  # [rad] rightmost and leftmost azimuth on the floor

    @classmethod
    def of(cls, camera: Camera, frame: str, simulated: bool) -> Self:
        """The description of a camera. The nearest floor is `farthest` where the camera sees none."""
        forward, left, up = (axis.table() for axis in scan_axes(camera))
        with np.errstate(divide="ignore", invalid="ignore"):
            depth = np.where(up < 0.0, -camera.floor.d / up, np.inf)  # at which a pixel's ray meets the floor
        seen = (depth <= camera.range[1]) & (forward > 0.0)
        farthest = float(np.hypot(forward, left).max()) * camera.range[1]
        nearest, view = farthest, (0.0, 0.0)
        if seen.any():
            column = seen.shape[1] // 2 if seen[:, seen.shape[1] // 2].any() else int(seen.any(axis=0).argmax())
            nearest = float((depth * forward)[:, column][seen[:, column]].min())
            azimuths = np.arctan2(left, forward)[seen]
            view = float(azimuths.min()), float(azimuths.max())
        return cls(frame=frame, simulated=simulated, nearest_floor=nearest, farthest=farthest, field_of_view=view)


class BodyDescription(Part):
    """What moves: a disc around the middle between the wheels."""

    simulated: bool  # whether its port leads to an emulated base
    radius: Metres  # [m]


class RobotDescription(Message):
    """One process's part of the description: `camera` comes from capture, `body` from the base's service."""

    stamp: Stamp
    camera: CameraDescription | None = None
    body: BodyDescription | None = None
