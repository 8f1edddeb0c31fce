"""The table of keys is the contract's."""

from pathlib import Path

import pytest

from cliffscan.common.contract import topics
from cliffscan.common.contract.messages import DepthImage, LaserScan, ServiceStatus
from cliffscan.common.contract.topics import Qos
from cliffscan.common.runtime import options

PAGE = (Path(__file__).parents[3] / "common" / "README.md").read_text()


@pytest.mark.parametrize(
    ("topic", "key", "message", "qos"),
    [
        (topics.DEPTH, "r/camera/depth", DepthImage, Qos.BULK),
        (topics.SCAN_POSITIVE, "r/scan/positive", LaserScan, Qos.REAL_TIME),
        (topics.SCAN_NEGATIVE, "r/scan/negative", LaserScan, Qos.REAL_TIME),
        (topics.SCAN_FUSED, "r/scan/fused", LaserScan, Qos.REAL_TIME),
        (topics.SCAN_SAFE, "r/scan/safe", LaserScan, Qos.REAL_TIME),
        (topics.SCAN_OF_METHOD.named("virtual_floor"), "r/scan/negative/virtual_floor", LaserScan, Qos.REAL_TIME),
        (topics.scan("scan/lidar"), "r/scan/lidar", LaserScan, Qos.REAL_TIME),
        (topics.at_workstation(topics.SCAN_FUSED), "r/workstation/scan/fused", LaserScan, Qos.REAL_TIME),
        (topics.STATUS.named("fuse"), "r/status/fuse", ServiceStatus, Qos.STATUS),
    ],
)
def test_a_topic_has_its_key_message_and_quality(topic, key, message, qos):
    assert (topic.key("r"), topic.message, topic.qos) == (key, message, qos)
    assert topics.message_at(topic.path) is message


@pytest.mark.parametrize("topic", topics.TOPICS, ids=lambda topic: topic.path)
def test_the_wire_page_has_the_row(topic):
    travels = topic.qos.name.lower().replace("_", " ")
    row = [f"`<robot>/{topic.path}`", topic.message.__name__, topic.rate, topic.writer, travels]
    assert f"| {' | '.join(row)} |\n" in PAGE


@pytest.mark.parametrize("topic", topics.TOPICS, ids=lambda topic: topic.path)
def test_each_key_of_a_row_has_its_message(topic):
    assert topics.message_at(topic.path) is topics.message_at(topic.named("anything").path) is topic.message


def test_no_two_rows_share_a_key():
    paths = [topic.path for topic in topics.TOPICS]
    assert len(set(paths)) == len(paths) > 15


def test_a_token_has_its_key():
    assert topics.alive("negative") == "alive/negative"


@pytest.mark.parametrize("path", ["based", "scanner", "alive/fuse", "statuses", "camera", "camera/depths", ""])
def test_a_key_that_is_nowhere_in_the_table_has_no_message(path):
    assert topics.message_at(path) is None


@pytest.mark.parametrize("name", ["turtlebot", "fleet/robot-7", "a.b_c", "7"])
def test_a_robot_may_be_called(name):
    assert options.robot_name(name) == name


@pytest.mark.parametrize("name", ["", "/r", "r/", "a//b", "a b", "*", "a/**", "a$*", "a?", "a#b", "r\n", "rö"])
def test_a_robot_may_not_be_called(name):
    with pytest.raises(Exception, match="no robot name"):
        options.robot_name(name)
