"""Wandering robots: the default does not fall where one without edges does, and every run can be run again."""

import math
from random import Random

import numpy as np
import pytest

from benchmarks.falls.bases import TURTLEBOT_2_SIZE
from benchmarks.falls.cases import Case, all_cases, length
from benchmarks.falls.driver import BACKWARD, ESCAPE, FORWARD, STUCK, Driver
from benchmarks.falls.floor import NEAR, Floor, arc
from benchmarks.falls.memory import Memory
from benchmarks.falls.report import report, write
from benchmarks.falls.sight import ENOUGH, MOST
from benchmarks.falls.trial import Trial, outcome_of
from cliffscan.common.contract.description import TURTLEBOT_2
from cliffscan.common.contract.messages import LaserScan
from cliffscan.safety.inputs import REST
from cliffscan.safety.rules import Decision
from cliffscan.simulator.world import Pose, World

HOLE = 8  # a world in which the driver soon wants to cross a hole


@pytest.fixture(scope="module")
def outcomes():
    return {mode: outcome_of(Case(mode, 0.5, HOLE), 6.0) for mode in ("default", "positive")}


def test_default_does_not_fall_where_a_robot_without_edges_does(outcomes):
    assert not [event.kind for event in outcomes["default"].events]
    assert outcomes["default"].seconds == pytest.approx(12.0, abs=0.02)
    assert [event.kind for event in outcomes["positive"].events] == ["cliff", "fall"]
    assert outcomes["positive"].seconds < 12.0


def test_report_and_files_tell_of_every_fall(outcomes, tmp_path):
    lines = report(list(outcomes.values()), 6.0).splitlines()
    assert sum(line.startswith(("| default | 0.5 | 1 |", "| positive | 0.5 | 1 |")) for line in lines) == 2
    write(list(outcomes.values()), tmp_path)
    assert f'"case": "positive:0.5:{HOLE}"' in (tmp_path / "events.json").read_text()
    assert f"default:0.5:{HOLE},random:{HOLE},12" in (tmp_path / "runs.csv").read_text()


@pytest.mark.parametrize("mode", ["default", "paper"])
def test_a_run_is_the_same_again(mode):
    first, again = (Trial(Case(mode, 0.35, 3)) for _ in range(2))
    first.run(2.5)
    again.run(2.5)
    assert first.log.track == again.log.track
    assert math.hypot(first.robot.pose.x, first.robot.pose.y) > 0.1


def test_a_robot_of_another_make_is_kept_from_falling_by_the_gate_for_any_base():
    """The hull of 0.70 m x 0.50 m goes somewhere, and nothing happens to it."""
    trial = Trial(Case("default", 0.35, HOLE, "differential_large"))
    outcome = trial.run(8.0)
    assert outcome.events == ()
    assert math.hypot(trial.robot.pose.x, trial.robot.pose.y) > 0.1
    assert {point.rule for point in trial.log.track} & {"free", "limit"}


def test_another_seed_is_another_run():
    one, other = (Trial(Case("positive", 0.35, seed)) for seed in (3, 4))
    one.run(2.0)
    other.run(2.0)
    assert one.log.track != other.log.track


def test_floor_ends_at_holes_and_walls():
    world = World("random:1")
    floor = Floor(world)
    at = {name: world.data.geom_xpos[world.model.geom(name).id, :2] for name in ("hole_1_ground", "wall_1", "floor_0")}
    assert not floor.free[floor.mask(np.array([at["hole_1_ground"]]))].any()
    assert not floor.free[floor.mask(np.array([at["wall_1"]]))].any()
    assert floor.reachable[floor.mask(np.array([at["floor_0"]]))].all()
    assert not (floor.reachable & ~floor.free).any()
    assert not (floor.roomy & ~floor.free).any()


def test_share_visited_grows_with_the_track():
    floor = Floor(World("random:1"))
    short, long = (arc(Pose(), 0.3, 0.1, metres) for metres in (0.5, 1.5))
    assert 0.0 < floor.visited(short) < floor.visited(long) < 1.0
    alone = floor.visited(np.zeros((1, 2))) * floor.area
    assert alone == pytest.approx(math.pi * NEAR**2, rel=0.1)


def test_arc_is_the_one_that_is_driven():
    end = arc(Pose(1.0, 2.0, math.pi / 2), 0.5, 0.5, math.pi / 2)[-1]
    np.testing.assert_allclose(end, [0.0, 3.0], atol=0.06)
    np.testing.assert_allclose(arc(Pose(0.0, 0.0, 0.0), -0.2, 0.0, 1.0)[-1], [-1.0, 0.0], atol=1e-9)


def test_memory_finds_ways_round_what_was_shut():
    memory = Memory((0.0, 0.0), (3.0, 3.0), TURTLEBOT_2_SIZE)
    for y in np.arange(0.0, 2.5, 0.1):
        memory.shut(1.3, y, 0.0)
    assert not memory.straight((1.0, 1.0), (2.0, 1.0))
    way = memory.ways((1.0, 1.0)).to(memory.square(2.0, 1.0))
    assert max(y for _, y in way) > 2.5
    assert way[-1] == pytest.approx((2.05, 1.05))


LOOKING = Pose(0.5, 1.5, 0.0)


def scan_of(ranges):
    """A fused scan of three or more beams over 60 degrees."""
    side = math.radians(30.0)
    return LaserScan(
        seq=0, stamp=0, frame="camera_footprint", angle_min=-side, angle_max=side,
        angle_increment=2 * side / (len(ranges) - 1), time_increment=0.0, scan_time=0.1, range_min=0.0, range_max=10.0,
        ranges=np.array(ranges, np.float32), intensities=np.zeros(0, np.float32),
    )  # fmt: skip


def ranges_to_line(distance, beams=241):
    """Ranges [m] to a line across, that far [m] ahead of the robot."""
    return (distance - TURTLEBOT_2.x) / np.cos(np.radians(np.linspace(-30.0, 30.0, beams)))


def looked(*scans, times=1, pose=LOOKING):
    """What is remembered of 3 m x 3 m after these ranges [m] were each seen that often, one after the other."""
    memory = Memory((0.0, 0.0), (3.0, 3.0), TURTLEBOT_2_SIZE)
    for scan in scans:
        for _ in range(times):
            memory.see(pose, scan_of(scan))
    return memory


def test_scans_shut_what_they_see_but_not_at_once():
    way = (0.5, 1.5), (1.4, 1.5)
    assert looked(ranges_to_line(1.0)).straight(*way)
    memory = looked(ranges_to_line(1.0), times=ENOUGH)
    assert not memory.straight(*way)
    assert memory.straight(way[0], (1.2, 1.5))
    assert not memory.straight((1.62, 0.9), (1.62, 2.1))
    round_it = memory.ways(way[0]).to(memory.square(2.5, 1.5))
    assert min(abs(y - 1.5) for x, y in round_it if abs(x - 1.5) < 0.1) > 0.6


def test_what_is_looked_past_opens_again_and_what_is_not_seen_does_not():
    way, wall, beams = ((0.5, 1.5), (2.0, 1.5)), ranges_to_line(1.0), 241
    for past, opens in (
        (ranges_to_line(2.0), True),
        (np.full(beams, np.inf), True),
        (np.full(beams, np.nan), False),
        (ranges_to_line(0.5), False),
        (ranges_to_line(1.06), False),
    ):
        assert looked(wall, past, times=MOST).straight(*way) is opens


def test_scans_that_see_nothing_shut_nothing():
    assert looked(np.full(241, np.nan), np.full(241, np.inf), ranges_to_line(9.0), times=MOST).straight(
        (0.5, 1.5), (2.9, 1.5)
    )


@pytest.mark.parametrize("aside", np.arange(0.0, 0.1, 0.02))
def test_a_passage_between_two_walls_stays_open(aside):
    angles = np.radians(np.linspace(-30.0, 30.0, 241))
    sides = 0.3 / np.abs(np.sin(angles)).clip(1e-6)
    memory = looked(np.where(sides < 2.5, sides, np.inf), times=MOST, pose=Pose(0.1, 1.5 + aside, 0.0))
    end = memory.square(1.9, 1.5 + aside)
    way = memory.ways((0.1, 1.5 + aside)).to(end)
    assert all(abs(y - 1.5 - aside) < 0.1 for _, y in way)
    assert not memory.straight((1.5, 1.5), (1.5, 1.9))


def test_where_the_robot_stands_and_stood_is_open():
    memory = looked(ranges_to_line(1.0), times=MOST)
    assert not memory.straight((0.5, 1.5), (2.0, 1.5))
    for x in np.arange(1.2, 1.9, 0.05):
        memory.visit(x, 1.5)
        assert memory.straight((x, 1.5), (x, 1.5))
    assert memory.straight((0.5, 1.5), (2.0, 1.5))
    assert not memory.straight((0.5, 1.7), (2.0, 1.7))


def commands_at(pose_at, seconds):
    """What a driver commands every 0.1 s of a robot that is at pose_at(time)."""
    driver, free = Driver((-3.0, -3.0), (3.0, 3.0), 0.3, Random(1), TURTLEBOT_2_SIZE), Decision("free", REST, REST)
    times = [0.05 + 0.1 * tick for tick in range(round(10 * seconds))]
    return [(now, driver.command(pose_at(now), free, now)) for now in times]


def test_a_driver_that_does_not_get_away_backs_off_goes_on_turns_the_other_way_and_backs_off_again():
    asked = commands_at(lambda _: Pose(), STUCK + 4 * ESCAPE + 1.0)
    wanted = next(twist.angular for now, twist in reversed(asked) if now < STUCK)
    for now, twist in asked:
        tries = (now - STUCK) / ESCAPE
        assert (twist == BACKWARD) is (0 <= tries < 1 or 3 <= tries < 4)
        assert (twist == FORWARD) is (1 <= tries < 2)
        if 2 <= tries < 3:
            assert twist.linear == 0.0
            assert twist.angular * wanted < 0.0


def test_a_driver_that_got_away_drives_on():
    asked = commands_at(lambda now: Pose(-0.1 if now > STUCK + ESCAPE / 2 else 0.0), STUCK + 2 * ESCAPE)
    assert [twist == BACKWARD for _, twist in asked] == [STUCK <= now < STUCK + ESCAPE for now, _ in asked]


def test_cases_share_the_time_and_the_worlds():
    cases = all_cases(("default", "paper"), (0.2, 0.4), 6, 10, "turtlebot2")
    assert [case.name for case in cases[:3]] == ["default:0.2:10", "paper:0.2:10", "default:0.4:11"]
    metres = length(30.0, 6, (0.2, 0.4))
    assert sum(metres / case.speed for case in cases if case.mode == "paper") == pytest.approx(1800.0)
    assert Case.parse("paper:0.2:10") == cases[1]
    other = Case("default", 0.2, 3, "differential_large")
    assert Case.parse(other.name) == other
