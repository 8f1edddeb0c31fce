"""The drive of ./demo --view goes on, round after round."""

from cliffscan.common.contract.base_messages import Odometry
from evaluation.processes.steering import Look
from experiments.watched import Rounds
from tests.build import odometry_fields


class Said:
    def __init__(self) -> None:
        self.velocities = []

    def put(self, message):
        self.velocities.append((message.linear, message.angular))


def test_it_begins_again_when_all_steps_are_done():
    said = Said()
    rounds = Rounds([Look(30), Look(0)], said)
    for number, theta in enumerate((0.0, 0.52, 0.0, 0.0, 0.0)):
        rounds.moved(Odometry.of(odometry_fields(stamp=10**9 + number * 10**8, pose=[0.0, 0.0, theta])))
    left, right, ended, again = (angular for _, angular in said.velocities[:4])
    assert left > 0.0 > right
    assert ended == 0.0
    assert again > 0.0


def test_it_commands_no_more_often_than_the_drive_of_the_demo():
    said = Said()
    rounds = Rounds([Look(90)], said)
    for number in range(10):
        rounds.moved(Odometry.of(odometry_fields(stamp=10**9 + number * 10**7)))
    assert len(said.velocities) == 2
