"""What is felt reaches the base's sensors, and leaves alone what was set by hand."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from cliffscan.simulator.kobuki.sensors import DROP_ADC, FLOOR_ADC, Sensors
from cliffscan.simulator.senses import CLIFF_EYES, FLOOR_DISTANCE, Feeling, Reporter, bumper, cliff_adc

NOTHING = Feeling(False, frozenset(), frozenset(), dict.fromkeys(CLIFF_EYES, FLOOR_DISTANCE))


@pytest.mark.parametrize(("angle", "side"), [(0, "centre"), (-20, "centre"), (40, "left"), (-89, "right"), (120, "")])
def test_a_push_belongs_to_the_bumper_in_its_direction(angle, side):
    assert bumper(math.radians(angle)) == side


@given(near=st.floats(0.0, 5.0), far=st.floats(0.0, 5.0))
def test_a_reading_falls_with_the_distance(near, far):
    near, far = sorted((near, far))
    assert DROP_ADC <= cliff_adc(far) <= cliff_adc(near) <= FLOOR_ADC


def test_what_is_felt_is_told():
    sensors = Sensors()
    depths = {"right": math.inf, "centre": FLOOR_DISTANCE, "left": 0.03}
    Reporter().report(Feeling(True, frozenset({"left"}), frozenset({"right"}), depths), sensors)
    assert (sensors.bumper, sensors.cliff, sensors.wheel_drop) == (4, 1, 1)
    assert sensors.cliff_adc == {"right": DROP_ADC, "centre": FLOOR_ADC, "left": cliff_adc(0.03)}


def test_a_fault_set_by_hand_stays_until_the_world_changes():
    sensors, reporter = Sensors(), Reporter()
    sensors.flag("bumper", "left", True)
    sensors.cliff_adc["centre"] = 7
    reporter.report(NOTHING, sensors)
    assert sensors.bumper == 4
    assert sensors.cliff_adc["centre"] == 7
    reporter.report(NOTHING._replace(bumpers=frozenset({"left"})), sensors)
    reporter.report(NOTHING, sensors)
    assert sensors.bumper == 0
