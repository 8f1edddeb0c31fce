"""What a SLAM plug-in publishes: the map, and where the robot is on it."""

from typing import Annotated, Self

from pydantic import Field, model_validator

from cliffscan.common.contract import limits
from cliffscan.common.contract.base_messages import Name, Triple
from cliffscan.common.contract.limits import MOST_CELLS
from cliffscan.common.contract.message import Int8s, Message, Stamp

UNKNOWN, OCCUPIED = -1, 100  # the least and the greatest value of a cell

Side = Annotated[int, Field(ge=1, le=MOST_CELLS)]  # cells


class OccupancyGrid(Message):
    """A map, with the values of ROS `nav_msgs/OccupancyGrid`."""

    stamp: Stamp  # of the newest scan on the map
    frame: Name
    resolution: Annotated[float, limits.RESOLUTION]  # [m] side of a cell
    width: Side
    height: Side
    origin: Triple  # of the lower left corner of the first cell
    data: Int8s  # row by row from the lowest y: -1 unknown, 0 free to 100 occupied

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        if self.width * self.height > MOST_CELLS:
            raise ValueError(f"width: {self.width} x {self.height} are more than {MOST_CELLS} cells")
        if len(self.data) != self.width * self.height:
            raise ValueError(f"data: {len(self.data)} cells, expected {self.width} x {self.height}")
        if ((self.data < UNKNOWN) | (self.data > OCCUPIED)).any():
            raise ValueError(f"data: a cell is not from {UNKNOWN} to {OCCUPIED}")
        return self


class Pose2D(Message):
    """Where the robot is on the map."""

    stamp: Stamp  # of the scan that it follows from
    frame: Name
    pose: Triple  # of base_link
