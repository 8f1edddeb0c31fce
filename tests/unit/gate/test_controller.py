"""What the gate for any base makes of odometry and contacts, whatever comes first."""

import math

import pytest

from cliffscan.common.contract.base_messages import BaseState, Odometry
from cliffscan.services.gate.config import GateConfig
from cliffscan.services.gate.controller import STATE_SILENT, GateController

BEGIN, PERIOD = 10**18, 0.02
FREE = (False, False, False)


class Base:
    """A base that says where it is and what it feels, every PERIOD."""

    def __init__(self):
        self.warned = []
        self.gate = GateController(GateConfig(require_scan=False), lambda count, why: self.warned.append((count, why)))
        self.now = 100.0

    def odometry(self, x=0.0):
        self.now += PERIOD
        message = Odometry(
            stamp=self.stamp, frame="odom", child_frame="base_link", pose=(x, 0.0, 0.0), twist=(0.0, 0.0),
            pose_covariance=[0.0] * 9, twist_covariance=[0.0] * 9,
        )  # fmt: skip
        self.gate.odometry(message, self.stamp, self.now)

    def state(self, cliffs=FREE, late=0.0):
        message = BaseState(
            stamp=self.stamp - round(late * 1e9), bumpers=FREE, cliffs=cliffs, cliff_counts=(0, 0, 0),
            wheel_drops=(False, False), overcurrents=(False, False), currents=(0.0, 0.0), buttons=FREE,
            battery_voltage=16.0, battery_percent=90.0,
            charger="discharging", dock_ir=(0, 0, 0), digital_inputs=(False,) * 4, analog_inputs=(0.0,) * 4,
        )  # fmt: skip
        self.gate.state(message, self.stamp, self.now)

    @property
    def stamp(self):
        return BEGIN + round(self.now * 1e9)

    def baselines(self):
        return [why for count, why in self.warned if count == "baseline"]


@pytest.fixture
def base():
    made = Base()
    for _ in range(10):
        made.odometry()
        made.state()
    return made


def test_a_contact_between_two_odometries_is_not_overlooked(base):
    base.state(cliffs=(False, True, False))
    base.state()
    base.odometry()
    assert base.gate.decision.rule == "cliff"


def test_a_base_that_began_anew_before_its_contacts_came_is_begun_anew(base):
    known = len(base.baselines())
    base.now += STATE_SILENT + 0.1
    base.odometry(x=7.0)
    base.odometry(x=7.0)
    assert len(base.baselines()) == known
    base.state()
    base.odometry(x=7.0)
    assert len(base.baselines()) == known + 1
    assert math.isclose(base.gate.alive_at, base.now)


def test_a_base_all_of_whose_states_are_refused_is_not_taken_for_one_that_feels_nothing():
    base = Base()
    for _ in range(round((STATE_SILENT + 0.2) / PERIOD)):
        base.odometry()
        base.state(cliffs=(True, True, True), late=0.25)
        base.gate.tick(base.now)
    assert base.gate.decision.rule == "no_base"
