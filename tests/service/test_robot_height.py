"""positive takes the robot's height from the base's description, unless it is set."""

import time

import numpy as np
import pytest

from cliffscan.common.contract.description import BodyDescription, RobotDescription
from tests import scenes
from tests.service.conftest import DEADLINE, image, ranges

CAMERA = scenes.camera()
BAR = scenes.depth(CAMERA, boxes=[(1.2, -0.2, 0.5, 1.4, 0.2, 0.8)], wall=60.0)  # from 0.5 to 0.8 m above the floor


def body(height):
    described = BodyDescription(simulated=True, radius=0.18, height=height)
    return RobotDescription(stamp=1, body=described).encode()


class Looking:
    """Frames of the bar, one after the other, and what positive finds in each."""

    def __init__(self, client) -> None:
        self._client, self._scans, self._seq = client, client.listen("scan/positive"), 0

    def nearest(self):
        """The nearest number [m] of the beams straight ahead; +inf where there is none."""
        self._seq += 1
        self._client.put("camera/depth", image(CAMERA, BAR, time.time_ns(), seq=self._seq))
        ahead = ranges(self._scans.get())[300:340]
        return np.min(ahead[np.isfinite(ahead)], initial=np.inf)

    def until(self, nearest):
        deadline = time.monotonic() + DEADLINE
        while self.nearest() != pytest.approx(nearest, rel=0.01):
            assert time.monotonic() < deadline


@pytest.mark.parametrize("service", ["positive", "perception"])
def test_the_described_height_counts_and_follows_a_change(client, start, service):
    start(service)
    looking = Looking(client)
    assert looking.nearest() == np.inf  # a TurtleBot 2 passes under the bar
    client.put("description", body(0.6))
    looking.until(1.2)
    client.put("description", body(0.02))  # no higher than the floor band
    client.put("description", body(0.45))
    looking.until(np.inf)


def test_a_height_that_is_set_counts_and_the_difference_is_logged_once(client, start):
    service = start("positive", "--set", "positive.robot_height=0.42")
    statuses, looking = client.listen("status/positive"), Looking(client)
    for _ in range(3):
        client.put("description", body(0.6))
    statuses.until(lambda status: status["counts"].get("height_differs") == 1)
    assert looking.nearest() == np.inf
    service.wait_said("the base describes 0.6 m")
    assert service.said.count("positive.robot_height is 0.42 m, the base describes 0.6 m") == 1
