"""Each setting says once what it means, in which unit and range, and a dump prints it."""

from typing import Annotated, Literal, get_args, get_origin

import pytest
from pydantic import Field

from cliffscan.common.runtime.config import CONFIGURED, ServiceConfig, dump
from cliffscan.common.runtime.settings import settings
from cliffscan.preflight import config_class
from cliffscan.services.fuse.config import ExtraInput

CLASSES = [*map(config_class, CONFIGURED), ExtraInput]


class Toaster(ServiceConfig):
    """A table."""

    power: Annotated[float, Field(gt=0, le=2500)] = 900.0
    """Heating power [W], of both slots
    together."""
    slots: Annotated[tuple[Literal["left", "right"], ...], Field(min_length=1)] = ("left",)
    """Slots that are used."""
    lamp: bool = True
    """Whether the lamp shines."""


def test_a_setting_has_meaning_unit_and_range():
    power, slots, lamp = settings(Toaster)
    assert (power.name, power.unit, power.allowed) == ("power", "W", "above 0, at most 2500")
    assert power.comment() == "Heating power [W], of both slots together. Above 0, at most 2500."
    assert slots.comment() == 'Slots that are used. Any of "left", "right", at least 1 of them.'
    assert (lamp.unit, lamp.comment()) == ("", "Whether the lamp shines.")


def test_a_dump_has_the_comment_above_the_value():
    lines = dump({"toaster": Toaster()}).splitlines()
    assert lines[:3] == [
        "[toaster]",
        "# Heating power [W], of both slots together. Above 0, at most 2500.",
        "power = 900.0",
    ]


@pytest.mark.parametrize("kind", CLASSES)
def test_every_setting_says_what_it_means(kind):
    assert [each.name for each in settings(kind) if not each.meaning.endswith(".")] == []


@pytest.mark.parametrize("kind", CLASSES)
def test_every_quantity_names_its_unit(kind):
    def is_quantity(annotation):
        return annotation is float or (get_origin(annotation) is tuple and float in get_args(annotation))

    assert [each.name for each in settings(kind) if is_quantity(each.field.annotation) and not each.unit] == []
