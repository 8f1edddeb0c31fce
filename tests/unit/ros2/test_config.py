"""Which topics drive, and what cannot be meant."""

import pytest

from cliffscan.common.runtime.config import ConfigError, dump, load
from cliffscan.services.ros2.config import Ros2Config


def loaded(*overrides):
    return load("ros2", Ros2Config, None, [f"ros2.commands.{override}" for override in overrides])


def test_without_a_word_cmd_vel_drives():
    ((source, given),) = Ros2Config().commands.items()
    assert (source, given.topic, given.priority) == ("ros2", "cmd_vel", 0)


def test_topics_that_are_named_replace_it():
    commands = loaded("teleop.topic=cmd_vel_teleop", "teleop.priority=5").commands
    assert {name: (each.topic, each.priority) for name, each in commands.items()} == {"teleop": ("cmd_vel_teleop", 5)}


def test_a_dump_is_read_back(tmp_path):
    config = loaded("teleop.topic=cmd_vel_teleop", "navigation.priority=-1")
    path = tmp_path / "robot.toml"
    path.write_text(dump({"ros2": config}))
    assert load("ros2", Ros2Config, path, []) == config


@pytest.mark.parametrize(
    ("overrides", "said"),
    [
        (["one.priority=1", "two.priority=2"], "cmd_vel is the topic of two sources: give each a topic of its own"),
        (["one.topic=/cmd_vel"], "ros2.commands.one.topic"),
    ],
)
def test_what_cannot_be_meant_is_refused_with_one_line(overrides, said):
    with pytest.raises(ConfigError) as refused:
        loaded(*overrides)
    assert said in str(refused.value)
    assert "\n" not in str(refused.value)
