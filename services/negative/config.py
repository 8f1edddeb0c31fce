"""The configuration of negative: the methods to run, and the settings of each."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, ClassVar, Literal, Self

from pydantic import Field, model_validator

from cliffscan.common.contract.message import ListAsTuple
from cliffscan.common.perception.scans import ImageScanConfig
from cliffscan.common.runtime.config import Profiles
from cliffscan.services.negative.methods import METHODS

if TYPE_CHECKING:
    MethodName = str
    AllSettings = ImageScanConfig
else:  # what a checker cannot know: the methods that are there
    MethodName = Literal[tuple(METHODS)]
    of_methods = [method.settings for method in METHODS.values() if method.settings is not ImageScanConfig]
    AllSettings = type("AllSettings", (*dict.fromkeys(of_methods), ImageScanConfig), {})


class NegativeConfig(AllSettings):
    """The methods to run and combine, and what the floor's end is."""

    PROFILES: ClassVar[Profiles] = {"paper": {"methods": ["farthest_point", "virtual_floor"]}}

    methods: Annotated[tuple[MethodName, ...], ListAsTuple, Field(min_length=1)] = ("near_edge",)
    """The methods whose scans are combined into scan/negative."""

    @model_validator(mode="after")
    def _each_once(self) -> Self:
        if len(set(self.methods)) < len(self.methods):
            raise ValueError("methods: one is named twice")
        return self
