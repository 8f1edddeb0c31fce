"""Which image size and rate is taken of those that a camera offers."""

import pytest

from cliffscan.common.runtime.config import ConfigError
from cliffscan.services.capture.sources.modes import best_mode

D435 = [(1280, 720, 30), (848, 480, 90), (848, 480, 30), (640, 480, 30), (640, 480, 15), (424, 240, 60)]


def best(size=(), modes=D435):
    return modes[best_mode(modes, size, "camera")]


def test_the_largest_at_thirty_hertz_that_is_not_too_large():
    assert best() == (848, 480, 30)
    assert best(modes=[(320, 240, 60), (320, 240, 30), (640, 480, 30)]) == (640, 480, 30)


def test_on_a_slow_port_the_rate_comes_first():
    assert best(modes=[(848, 480, 6), (480, 270, 30), (640, 480, 15)]) == (480, 270, 30)


def test_a_configured_size_is_taken_at_the_nearest_rate():
    assert best((1280, 720)) == (1280, 720, 30)
    assert best((424, 240)) == (424, 240, 60)


def test_a_camera_with_large_images_alone_is_taken():
    assert best(modes=[(1280, 720, 30), (1920, 1080, 30)]) == (1920, 1080, 30)


def test_a_size_that_is_not_offered_is_refused_with_those_that_are():
    with pytest.raises(
        ConfigError, match=r"capture\.size: camera has no depth of \[1, 2\]; .*\[424, 240\].*\[1280, 720\]"
    ):
        best((1, 2))


def test_a_camera_without_any_depth_is_refused():
    with pytest.raises(ConfigError, match="choose one of none"):
        best(modes=[])
