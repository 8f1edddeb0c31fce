"""Each rule of the gate, and which one comes first."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from cliffscan.safety.arc_collision import safe_speed
from cliffscan.safety.gate import SafetyGate
from cliffscan.safety.inputs import REST, Command, Twist
from cliffscan.safety.pose2d import Pose2D
from cliffscan.safety.rules import NOTHING
from cliffscan.safety.scan_claims import Scan, View
from tests import build
from tests.gate_drive import HERE, LIMITS, TICK, Drive

VIEW = View.undescribed()


def test_the_default_latency_covers_the_base_and_the_time_between_decisions():
    assert LIMITS.reaction >= 0.2 + 2 * TICK


def test_a_message_tells_where_the_floor_ends_and_how_far_it_was_seen():
    sent = build.scan([1, 1, 1, 1, 1, math.inf], [1, 2, 3, 4, 5, 0], [0.9, 0.8, 0.7, 0.6, 0.5, 3.0])
    told = Scan.of(sent, VIEW)
    assert told.edges.tolist() == [False, True, True, True, False, False]
    np.testing.assert_allclose(told.free, [0.9, 0.8, 0.7, 0.6, 0.5, 3.0], rtol=1e-6)
    np.testing.assert_array_equal(told.ranges, [1, 1, 1, 1, 1, math.inf])


def test_a_message_of_nothing_but_ranges_is_taken_at_its_word():
    told = Scan.of(build.scan([1.0, math.inf, math.nan]), VIEW)
    assert not told.edges.any()
    np.testing.assert_array_equal(told.free, [1.0, 10.0, 0.0])


def test_with_nothing_in_the_way_it_does_what_was_asked():
    assert Drive().steady(0.3, 0.2)[:3] == ("free", (0.3, 0.2), (0.3, 0.2))


def test_nothing_moves_before_the_base_was_heard_nor_after_it_fell_silent():
    assert SafetyGate(LIMITS, HERE).decide(Command(Twist(0.3, 0.0), 1.0), 1.0)[:2] == ("no_base", REST)
    drive = Drive()
    drive.steady(0.3)
    drive.safety.lose_base()
    assert drive.decide()[:2] == ("no_base", REST)


def test_no_command_for_0_3_s_stops_it():
    drive = Drive()
    drive.steady(0.3)
    rules = [drive.tick(0, command=False).rule for _ in range(17)]
    assert rules[:14] == ["free"] * 14
    assert rules[15:] == ["no_command"] * 2
    assert drive.tick(0, command=False).allowed == REST


def test_without_a_fresh_scan_it_stops_and_then_turns_slowly():
    drive = Drive()
    drive.steady(0.3, 1.0)
    decisions = [drive.tick(0.3, 1.0, scan=False) for _ in range(100)]
    assert [d.rule for d in decisions].index("no_scan") in (14, 15)
    assert decisions[16].allowed == REST
    assert all(d.allowed.linear == 0.0 for d in decisions[16:])
    assert decisions[-1].allowed == (0.0, math.radians(30))


@pytest.mark.parametrize("late", [0.31, 5.0])
def test_a_scan_that_comes_late_is_not_fresh(late):
    drive = Drive()
    drive.now += 10
    for _ in range(20):
        decision = drive.tick(0.3, taken=drive.now - late)
    assert decision.rule == "no_scan"


def test_a_clock_ahead_does_not_make_old_scans_fresh():
    drive = Drive()
    drive.tick(0.3, taken=drive.now + 50.0)
    for _ in range(30):
        decision = drive.tick(0.3, taken=100.0)
    assert decision.rule == "no_scan"


def test_a_scan_that_was_overtaken_frees_nothing():
    drive = Drive(ranges=1.0)
    drive.tick(0.7)
    drive.ranges = math.inf
    drive.tick(0.7, taken=99.0)
    assert drive.steady(0.7, scan=False, ticks=10).rule != "no_scan"
    assert drive.safety._grid.not_free(HERE, 1.2, unknown_too=False).size


def test_where_no_scan_is_required_it_drives_without():
    drive = Drive(require_scan=False)
    for _ in range(300):
        decision = drive.tick(0.4, scan=False)
        drive.pose = drive.pose.then(Pose2D(decision.allowed.linear * TICK, 0.0, 0.0))
    assert decision.allowed == (0.4, 0.0)


@given(st.floats(0.9, 1.45), st.sampled_from([0.05, 0.2, 0.4, 0.7]))
@settings(max_examples=12)
def test_it_is_as_fast_as_it_can_brake_from(far, asked):
    decision = Drive(ranges=far).steady(asked)
    nearest = far + VIEW.camera.x - LIMITS.radius - LIMITS.margin
    fastest = safe_speed(nearest, LIMITS.deceleration, LIMITS.reaction)
    assert decision.allowed.linear <= min(asked, fastest) + 1e-9
    assert decision.allowed.linear >= min(asked, fastest) - 0.08
    assert decision.rule == ("free" if decision.allowed.linear == asked else "obstacle")
    assert (decision.distance == NOTHING) == (decision.rule == "free")


def test_slowing_down_keeps_the_curvature():
    decision = Drive(ranges=0.8).steady(0.7, 0.35)
    assert decision.rule == "obstacle"
    assert decision.allowed.angular / decision.allowed.linear == pytest.approx(0.5)


def test_speeds_are_limited_on_the_same_arc():
    decision = Drive().steady(2.0, 1.0, ticks=400)
    assert decision.rule in ("limit", "obstacle")
    drive = Drive(max_linear=0.2)
    assert drive.steady(2.0, 1.0).allowed == pytest.approx((0.2, 0.1))
    assert drive.steady(0.0, -9.0).allowed == pytest.approx((0.0, -math.radians(110)))


def test_accelerations_are_limited_and_the_arc_is_kept_from_the_start():
    drive, before = Drive(), REST
    drive.tick(0.0)
    for _ in range(100):
        now = drive.tick(0.3, 1.2).allowed
        assert now.linear - before.linear <= 0.5 * TICK + 1e-9
        assert now.angular - before.angular <= math.radians(200) * TICK + 1e-9
        if now.linear:
            assert now.angular / now.linear == pytest.approx(4.0)
        before = now
    assert drive.tick(0.0).allowed == REST


def test_decisions_in_quick_succession_do_not_add_up_and_a_pause_counts_as_0_1_s():
    drive = Drive()
    first = drive.tick(0.7).allowed.linear
    assert all(drive.decide().allowed.linear == first for _ in range(50))
    drive.now += 60
    assert drive.tick(0.7).allowed.linear <= first + 0.5 * 0.1 + 1e-9


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
def test_a_command_that_is_no_number_is_none(value):
    drive = Drive()
    drive.command = Command(Twist(value, 0.0), drive.now)
    assert drive.tick(0, command=False).rule == "no_command"


@pytest.mark.parametrize(("sensor", "rule"), [("drop", "wheel_drop"), ("over", "overcurrent")])
def test_motors_are_off_until_released(sensor, rule):
    drive = Drive()
    drive.steady(0.3)
    drive.sensors = {sensor: 1}
    assert drive.tick(0.3)[:2] == (rule, REST)
    drive.sensors = {}
    assert drive.tick(0.3).allowed.linear > 0.0


@pytest.mark.parametrize("kind", ["bumper", "cliff"])
def test_it_backs_off_whatever_is_asked_and_then_keeps_away(kind):
    drive = Drive()
    drive.steady(0.3)
    drive.sensors = {kind: 2}
    assert drive.tick(0.3)[:2] == (kind, (-0.1, 0.0))
    drive.go(0.3, ticks=10)
    drive.sensors = {}
    while drive.tick(0.3, command=False).rule == kind:
        drive.pose = drive.pose.then(Pose2D(-0.002, 0.0, 0.0))
    assert -0.12 < drive.pose.x < 0.0
    assert drive.go(0.3).x < 0.0
    assert drive.tick(0.3).rule == "obstacle"
    assert drive.steady(0.0, 1.0).allowed == (0.0, 1.0)
    drive.safety.clear()
    assert drive.steady(0.3).allowed.linear == pytest.approx(0.3)


@pytest.mark.parametrize("how", ["asked", "button"])
def test_the_emergency_stop_holds_until_it_is_cleared(how):
    drive = Drive()
    drive.steady(0.3)
    if how == "button":
        drive.sensors = {"button": True}
        drive.tick(0.3)
        drive.sensors = {}
    else:
        drive.safety.stop("asked to")
    assert drive.steady(0.3)[:2] == ("stopped", REST)
    drive.safety.restart(drive.pose, 0.6)
    assert drive.steady(0.3).rule == "stopped"
    drive.safety.clear()
    assert drive.steady(0.3).rule == "free"


def test_the_strongest_rule_comes_first():
    drive, rules = Drive(), []
    drive.steady(0.3)
    drive.safety.stop("asked to")
    drive.sensors = {"drop": 1, "over": 1, "cliff": 2, "bumper": 2}
    rules.append(drive.tick(0.3).rule)
    drive.safety.clear()
    for released in ("drop", "over", "cliff"):
        rules.append(drive.tick(0.3).rule)
        del drive.sensors[released]
    drive.safety.clear()
    rules.append(drive.tick(0.3).rule)
    assert rules == ["stopped", "wheel_drop", "overcurrent", "cliff", "bumper"]
