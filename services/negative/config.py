"""The configuration of negative."""

from __future__ import annotations

from typing import Annotated, ClassVar, Literal, Self

from pydantic import Field, model_validator

from cliffscan.common.contract.camera import Camera
from cliffscan.common.contract.message import ListAsTuple
from cliffscan.common.perception.scans import ScanConfig, steepest_rise
from cliffscan.common.runtime.config import Profiles
from cliffscan.services.negative.floor_following import FloorCriteria
from cliffscan.services.negative.near_edge import FloorLost

Method = Literal["farthest_point", "virtual_floor", "near_edge"]

TRUSTED = 0.97  # of the sensor's range; beyond, noise takes depths out of it


class NegativeConfig(ScanConfig):
    """The beams of the scans, the methods to run and combine, and what a floor is."""

    PROFILES: ClassVar[Profiles] = {"paper": {"methods": ["farthest_point", "virtual_floor"], "floor_band": 0.03}}

    methods: Annotated[tuple[Method, ...], ListAsTuple, Field(min_length=1)] = ("near_edge",)
    """The methods whose scans are combined into scan/negative."""

    # near_edge
    floor_lost: FloorLost = "counts"
    """What floor without data is: it counts as a drop, counts only beside_drop that is seen, or is ignored."""
    steepest: Annotated[float, Field(ge=0, le=20)] = 5.0
    """Slope [deg] up to which a ramp is floor."""
    least_drop: Annotated[float, Field(ge=0.01, le=0.2)] = 0.025
    """Height [m] of the lowest step down that is a drop; a lower one is floor."""
    least_gap: Annotated[float, Field(ge=0.02, le=1)] = 0.12
    """Length [m] of floor without data from which on it is lost; less is chance."""
    sight: Annotated[float, Field(gt=0, le=20)] = 4.0
    """Distance [m] up to which the sensor sees floor, if its range allows."""
    grazing: Annotated[float, Field(ge=0.01, le=0.5)] = 0.07
    """Sine [1] of the angle below which floor may return nothing."""
    noise: Annotated[float, Field(ge=1e-4, le=0.1)] = 1.64e-3
    """Standard deviation [1/m] of the inverse depth, the sensor's steps included."""
    baseline: Annotated[float, Field(ge=0, le=1)] = 0.075
    """Distance [m] between camera and projector, which makes shadows as wide."""

    @model_validator(mode="after")
    def _each_once(self) -> Self:
        if len(set(self.methods)) < len(self.methods):
            raise ValueError("methods: one is named twice")
        return self

    def criteria(self, camera: Camera) -> FloorCriteria[float]:
        """What near_edge takes for floor in images of a camera."""
        near, far = camera.range
        slope = steepest_rise(self.steepest)
        return FloorCriteria(
            near, min(TRUSTED * far, self.sight), self.noise, self.grazing, slope, self.least_drop, self.least_gap
        )
