"""The files for ROS 2 name topics that are published, and agree with one another and with the defaults."""

from pathlib import Path

import pytest
from ruamel.yaml import YAML

from cliffscan.services.ros2.config import Ros2Config
from cliffscan.services.ros2.node import Profile
from cliffscan.services.ros2.outputs import feeds
from cliffscan.services.ros2.scans import range_max
from tests.build import service

FOLDER = Path(__file__).parents[3] / "examples/ros2"
SLAM_RANGE = Ros2Config().slam_range


class StandIn:
    """A node that notes what would be published."""

    def __init__(self) -> None:
        self.profiles = {}

    def publisher(self, topic, _interface, profile):
        self.profiles[f"/{topic}"] = profile


def parameters(name):
    """The parameters of each node in a file, by node."""
    tree = YAML(typ="safe").load((FOLDER / name).read_text())
    found = {}

    def walk(path, node):
        if "ros__parameters" in node:
            found[path] = node["ros__parameters"]
        else:
            for key, child in node.items():
                walk(f"{path}/{key}", child)

    walk("", tree)
    return found


@pytest.mark.parametrize("costmap", ["local_costmap", "global_costmap"])
def test_a_costmap_marks_with_one_scan_and_clears_with_the_other(costmap):
    given = parameters("nav2_costmaps.yaml")[f"/{costmap}/{costmap}"]
    layer = given["cliff_layer"]
    assert "cliff_layer" in given["plugins"]
    assert layer["footprint_clearing_enabled"] is False
    marks, clear = (layer[source] for source in layer["observation_sources"].split())
    assert (marks["topic"], marks["marking"], marks["clearing"]) == ("/scan_marks", True, False)
    assert (clear["topic"], clear["marking"], clear["clearing"]) == ("/scan_clear", False, True)
    assert marks["inf_is_valid"] is clear["inf_is_valid"] is False
    assert marks["obstacle_max_range"] == clear["raytrace_max_range"] == SLAM_RANGE
    assert clear["raytrace_min_range"] == 0.72


def test_slam_toolbox_frees_as_far_as_the_scan_means():
    given = parameters("slam_toolbox.yaml")["/slam_toolbox"]
    assert (given["scan_topic"], given["max_laser_range"]) == ("/scan", SLAM_RANGE)
    assert given["max_laser_range"] < range_max(SLAM_RANGE)
    assert given["base_frame"] == Ros2Config().base_frame


def test_the_collision_monitors_stop_zone_reaches_beyond_the_blind_zone():
    given = parameters("collision_monitor.yaml")["/collision_monitor"]
    assert [given[source]["topic"] for source in given["observation_sources"]] == ["/scan_marks"]
    corners = YAML(typ="safe").load(given["stop"]["points"])
    assert max(x for x, _ in corners) > 0.72


def test_rviz_shows_topics_that_are_published_as_they_are_published():
    shown = YAML(typ="safe").load((FOLDER / "cliffscan.rviz").read_text())["Visualization Manager"]
    subscribed = {}
    for display in shown["Displays"]:
        for key in ("Topic", "Description Topic"):
            if key in display:
                topic = display[key]
                subscribed[topic["Value"]] = topic["Reliability Policy"], topic["Durability Policy"]
    published = {
        Profile.SENSOR_DATA: ("Best Effort", "Volatile"),
        Profile.LATCHED: ("Reliable", "Transient Local"),
    }
    made = StandIn()
    robot = service("ros2", Ros2Config())
    robot.bus.beside = lambda _name: robot.bus
    feeds(robot, made)
    assert subscribed == {topic: published[made.profiles[topic]] for topic in subscribed}
    assert len(subscribed) == 6
    assert shown["Global Options"]["Fixed Frame"] == "odom"
    assert shown["Views"]["Current"]["Target Frame"] == Ros2Config().base_frame
