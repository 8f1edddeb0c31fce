"""The configuration of negative."""

from __future__ import annotations

from typing import Annotated, ClassVar, Literal, Self

from pydantic import Field, model_validator

from cliffscan.common.contract.camera import Camera
from cliffscan.common.contract.message import ListAsTuple
from cliffscan.common.perception.scans import ScanConfig, steepest_rise
from cliffscan.common.runtime.config import Profiles
from cliffscan.services.negative.floor_following import Limits
from cliffscan.services.negative.near_edge import FloorLost

Method = Literal["farthest_point", "virtual_floor", "near_edge"]

TRUSTED = 0.97  # of the sensor's range; beyond, noise takes depths out of it


class NegativeConfig(ScanConfig):
    """The beams of the scans, the methods to run and combine, and what a floor is."""

    PROFILES: ClassVar[Profiles] = {"paper": {"methods": ["farthest_point", "virtual_floor"], "floor_band": 0.03}}

    methods: Annotated[tuple[Method, ...], ListAsTuple, Field(min_length=1)] = ("near_edge",)

    # near_edge
    floor_lost: FloorLost = "counts"  # floor without data: counts as a drop, counts beside_drop seen, or is ignored
    steepest: Annotated[float, Field(ge=0, le=20)] = 5.0  # [deg] a ramp up to here is floor
    least_drop: Annotated[float, Field(ge=0.01, le=0.2)] = 0.025  # [m] a lower step down is floor
    least_gap: Annotated[float, Field(ge=0.02, le=1)] = 0.12  # [m] floor without data over less is chance
    sight: Annotated[float, Field(gt=0, le=20)] = 4.0  # [m] the sensor sees floor up to here, if its range allows
    grazing: Annotated[float, Field(ge=0.01, le=0.5)] = 0.07  # sine of the angle below which floor may return nothing
    noise: Annotated[float, Field(ge=1e-4, le=0.1)] = 1.64e-3  # [1/m] σ of the inverse depth, steps included
    baseline: Annotated[float, Field(ge=0, le=1)] = 0.075  # [m] between camera and projector: how wide shadows are

    @model_validator(mode="after")
    def _each_once(self) -> Self:
        if len(set(self.methods)) < len(self.methods):
            raise ValueError("methods: one is named twice")
        return self

    def limits(self, camera: Camera) -> Limits:
        """What near_edge takes for floor in images of a camera."""
        near, far = camera.range
        slope = steepest_rise(self.steepest)
        return Limits(
            near, min(TRUSTED * far, self.sight), self.noise, self.grazing, slope, self.least_drop, self.least_gap
        )
