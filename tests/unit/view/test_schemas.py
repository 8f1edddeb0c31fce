"""The definitions that Foxglove's viewers are sent are those of ROS, word by word."""

import pytest
from rosbags.typesys import Stores, get_typestore

from cliffscan.recording.definitions import SEPARATOR, schema
from cliffscan.view.foxglove_channels import channels

NAMES = sorted({channel.schema for channel in channels()})


def parts(text):
    """The fields of each definition by its heading."""
    sections = [section.strip().splitlines() for section in text.split(SEPARATOR)]
    named = {(lines[0] if number else ""): lines[bool(number) :] for number, lines in enumerate(sections)}
    return {name: [line.strip() for line in lines if line.strip()] for name, lines in named.items()}


@pytest.mark.parametrize("name", NAMES)
def test_a_schema_is_the_one_of_ros(name):
    theirs, _ = get_typestore(Stores.ROS2_JAZZY).generate_msgdef(name, ros_version=2)
    assert parts(schema(name)) == parts(theirs)
