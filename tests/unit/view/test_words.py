"""The page has words for every rule of the gate, and says what a person can do."""

from typing import get_args

import pytest

from cliffscan.common.contract.base_messages import Rule, SafetyState
from cliffscan.view.words import HEADLINES, REMEDY, notice, why

RULES = get_args(Rule)


def state(rule, **changes):
    fields = {"stamp": 1, "rule": rule, "distance": -1.0, "asked": (0.2, 0.0), "allowed": (0.0, 0.0)}
    return SafetyState(**(fields | {"latched": False, "note": ""} | changes))


def test_every_rule_has_its_own_headline_and_a_remedy():
    assert set(HEADLINES) == set(REMEDY) == set(RULES)
    assert len({headline.text for headline in HEADLINES.values()}) == len(RULES)


@pytest.mark.parametrize("rule", [rule for rule in RULES if rule not in ("free", "limit", "no_command")])
def test_whatever_stops_the_robot_is_loud_and_explained(rule):
    words = why(state(rule))
    assert words.level in ("held", "alarm")
    assert words.reason
    assert words.remedy


def test_what_is_in_the_way_is_the_headline():
    note = "edge ahead, 0.12 m from the hull"
    stopped = why(state("obstacle", note=note, distance=0.09))
    assert (stopped.headline, stopped.level) == ("Stopped: edge ahead", "held")
    assert stopped.reason == f"{note}, 0.09 m to go"
    slowed = why(state("obstacle", note=note, allowed=(0.1, 0.0)))
    assert (slowed.headline, slowed.level) == ("Slowed down: edge ahead", "slowed")


def test_a_pressed_stop_that_another_rule_hides_is_not_forgotten():
    assert "A stop is pressed as well" in why(state("bumper", latched=True)).remedy


def test_what_is_missing_is_said_with_its_remedy():
    assert notice(True, True, "a", ["b"], "") == ""
    assert "cliffscan up" in notice(False, False, "a", [], "at x")
    assert "cliffscan up" in notice(True, False, "a", [], "at x")
    assert "choose one" in notice(True, False, "a", ["b"], "")
