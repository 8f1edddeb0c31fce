"""The table of type hashes, computed again from the definitions."""

import pytest
from ros2_pyterfaces.cydr.all_srvs import Trigger
from rosbags.typesys import Stores, get_typestore

from cliffscan.services.ros2.interfaces import INTERFACES, TRIGGER

MESSAGES = [each for each in INTERFACES if each.kind == "msg"]
STORES = [Stores.ROS2_JAZZY, Stores.ROS2_KILTED]


def test_no_interface_is_there_twice():
    assert len({each.dds_name for each in INTERFACES}) == len(INTERFACES) == 14


@pytest.mark.parametrize("interface", MESSAGES, ids=lambda interface: interface.name)
@pytest.mark.parametrize("store", STORES, ids=lambda store: store.value)
def test_a_hash_is_that_of_the_definition(interface, store):
    name = f"{interface.package}/msg/{interface.name}"
    assert get_typestore(store).hash_rihs01(name) == interface.type_hash


def test_the_hash_of_a_service_is_that_of_its_definition():
    assert TRIGGER.type_hash == Trigger.hash_rihs01()
    assert TRIGGER.dds_name == "std_srvs::srv::dds_::Trigger_"


def test_a_type_has_its_name_on_the_wire():
    assert INTERFACES[0].dds_name == "sensor_msgs::msg::dds_::LaserScan_"
