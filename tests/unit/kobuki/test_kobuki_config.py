"""What the camera's description says is no setting of the base, and whoever sets it is referred to the new place."""

import math

import pytest

from cliffscan.common.runtime.config import ConfigError, load
from cliffscan.services.kobuki.config import KobukiConfig


@pytest.mark.parametrize(
    ("override", "remedy"),
    [
        (
            "kobuki.camera_x=-0.1",
            "kobuki.camera_x is gone, for the camera's description says it: set capture.x instead",
        ),
        ("kobuki.camera_yaw=5.0", "set capture.yaw instead"),
        ("kobuki.blind=1.0", "it follows from capture.height and capture.pitch"),
    ],
)
def test_a_setting_that_is_gone_names_the_new_one(override, remedy):
    with pytest.raises(ConfigError) as refused:
        load("kobuki", KobukiConfig, None, [override])
    assert remedy in str(refused.value)
    assert "\n" not in str(refused.value)


def test_the_gate_takes_si_units():
    limits = KobukiConfig(max_angular=90.0, angular_acceleration=180.0, slow_turn=45.0, robot_radius=0.2).limits()
    assert (limits.max_angular, limits.angular_acceleration) == pytest.approx((math.pi / 2, math.pi))
    assert (limits.slow_turn, limits.radius) == pytest.approx((math.pi / 4, 0.2))
