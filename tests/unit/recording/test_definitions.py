"""The definitions of a recording's messages are those of ROS."""

import pytest
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

from cliffscan.recording.definitions import schema
from cliffscan.recording.envelope import SAMPLE
from cliffscan.recording.ros_view import RosView


class Interfaces(RosView):
    """All that is recorded for ROS."""

    def __init__(self):
        self.used = {SAMPLE}
        super().__init__("turtlebot", lambda _topic, _payload: None, images=1.0)

    def publisher(self, topic, interface, profile):
        self.used.add(interface)
        return super().publisher(topic, interface, profile)


USED = sorted(Interfaces().used)


def test_scans_transforms_and_images_are_recorded():
    assert {"LaserScan", "TFMessage", "Image", "Sample"} < {each.name for each in USED}


@pytest.mark.parametrize("interface", USED, ids=lambda interface: interface.name)
def test_a_schema_defines_the_type_that_the_hash_is_of(interface):
    empty = get_typestore(Stores.EMPTY)
    empty.register(get_types_from_msg(schema(interface.message_name), interface.message_name))
    assert empty.hash_rihs01(interface.message_name) == interface.type_hash


def test_a_message_that_is_part_of_two_others_is_defined_once():
    assert schema("nav_msgs/msg/OccupancyGrid").count("MSG: builtin_interfaces/Time") == 1
