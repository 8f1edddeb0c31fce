"""The configuration of negative."""

from __future__ import annotations

from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from common.message import ListAsTuple
from common.scans import ScanConfig

Method = Literal["farthest_point", "virtual_floor"]


class NegativeConfig(ScanConfig):
    """The beams of the scans, the floor band, and the methods to run and combine."""

    methods: Annotated[tuple[Method, ...], ListAsTuple, Field(min_length=1)] = ("farthest_point", "virtual_floor")

    @model_validator(mode="after")
    def _each_once(self) -> Self:
        if len(set(self.methods)) < len(self.methods):
            raise ValueError("methods: one is named twice")
        return self
