"""Whatever comes in whatever order: a robot that obeys the gate, late and with weak brakes, drives over nothing.

The world does not move. It has voids, half-planes in which there is no floor, and posts, which a scan shows where they
begin. The camera is blind nearer than BLIND: there it does not show a post at all, and of a void only that there is no
floor at BLIND. A dark void is not shown at all: its beams are NaN. So a void must never be driven into forward, seen or
not; and what was seen, never.
"""

import math

import pytest
from hypothesis import HealthCheck, settings
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, initialize, precondition, rule

from tests.gate_trial import Trial

directions = st.floats(-math.pi, math.pi)
far = st.one_of(st.floats(0.55, 2.5), st.floats(1.5, 2.5))
voids = st.lists(st.tuples(directions, far), min_size=1, max_size=2)  # bearing and distance [m] of an edge
ahead = st.lists(st.tuples(st.floats(-0.5, 0.5), st.floats(0.55, 1.2)), min_size=1, max_size=2)
posts = st.lists(st.tuples(directions, st.floats(0.45, 2.5), st.floats(0.03, 0.2)), min_size=1, max_size=4)
linears = st.sampled_from([0.7, 0.7, 0.4, 0.7, 0.4, 0.2, 0.05, 0.0, -0.1, -0.4, 3.0])
angulars = st.sampled_from([0.0, 0.0, 0.1, -0.1, 0.5, -0.5, 1.0, -1.0, 1.9, -1.9])
things = st.integers(0, 5)
gaps = st.sampled_from([0.0, 0.1, 0.3])  # [m]
sides = st.sampled_from([1, -1])
turns = st.sampled_from([0.5, 1.0, 1.9])
keeps = st.sampled_from([0.7, 0.7, 0.3, 0.0])
asides = st.sampled_from([0.0, 0.0, 0.2, -0.2, 0.6, -0.6])


class Gate(RuleBasedStateMachine):
    @initialize(
        voids=voids,
        posts=posts,
        dead=st.sampled_from([0.23, 0.0, 0.1, 0.23]),
        late=st.sampled_from([0.0, 0.06, 0.12]),
        dark=st.booleans(),
    )
    def begin(self, **how):
        self.trial = Trial(**how)

    @rule(linear=linears, angular=angulars, ticks=st.sampled_from([2, 15, 40, 40, 100, 200]))
    def drive(self, linear, angular, ticks):
        self.trial.drive(linear, angular, ticks)

    @rule(which=things, aside=asides, linear=st.sampled_from([0.7, 0.7, 0.3]))
    def go_for(self, which, aside, linear):
        """As fast as it may towards something."""
        self.trial.face(self.trial.world.way_to(which, self.trial.pose) + aside)
        self.trial.drive(linear, 0.0, 150)

    @rule(which=things, gap=gaps, side=sides, away=st.sampled_from([0.0, 0.1, -0.1]), turn=turns, linear=keeps)
    def go_along(self, which, gap, side, away, turn, linear):
        """Past something, near it, and then towards it."""
        way = self.trial.world.way_to(which, self.trial.pose)
        self.trial.approach(way, gap)
        self.trial.face(way + side * (math.pi / 2 + away))
        self.trial.drive(0.7, 0.0, 60)
        self.trial.drive(linear, -side * turn, 60)

    @rule(angular=angulars, ticks=st.sampled_from([40, 100]))
    def go_where_it_can(self, angular, ticks):
        self.trial.face(self.trial.world.open_way(self.trial.pose))
        self.trial.drive(0.7, 0.3 * angular, ticks)

    @rule(which=things, aside=asides, linear=st.sampled_from([-0.4, -0.7]), turn=angulars)
    def back_into(self, which, aside, linear, turn):
        """Look at something, turn round, and go back."""
        way = self.trial.world.way_to(which, self.trial.pose)
        self.trial.face(way)
        self.trial.face(way + math.pi + aside)
        self.trial.drive(linear, 0.2 * turn, 100)

    @rule(turns=st.lists(angulars, min_size=2, max_size=6), linear=linears, ticks=st.integers(5, 40))
    def swerve(self, turns, linear, ticks):
        for angular in turns:
            self.trial.drive(linear, angular, ticks)

    @rule(angular=st.sampled_from([1.9, -1.9]), linear=linears, ticks=st.integers(20, 120))
    def spin_and_go(self, angular, linear, ticks):
        """Turning on the spot brings what was seen out of view, or into the blind zone."""
        self.trial.drive(0.0, angular, ticks)
        self.trial.drive(linear, 0.0, 60)

    @rule()
    def look_at_all(self):
        self.trial.hidden = slice(0, 0)

    @rule(first=st.integers(0, 159), beams=st.integers(1, 160), ticks=st.integers(1, 20))
    def see_less(self, first, beams, ticks):
        self.trial.hidden = slice(first, first + beams)
        self.trial.run(ticks)

    @rule(dark=st.booleans())
    def darken(self, dark):
        self.trial.dark = dark

    @rule(ticks=st.integers(1, 40), what=st.sampled_from(["scans", "commands", "scan"]), free=st.booleans())
    def miss(self, ticks, what, free):
        """Nothing new is heard of the floor, or of the driver, or the same scan comes again and again."""
        if free:
            self.go_where_it_can(0.0, 20)
        self.trial.run(ticks, commands=what != "commands", scans=what == "commands", frozen=what == "scan")

    @rule(ticks=st.integers(1, 10), sensors=st.sampled_from([{"drop": 1}, {"over": 2}, {"bumper": 4}, {"cliff": 2}]))
    def sense(self, ticks, sensors):
        self.trial.sense(ticks, **sensors)

    @rule(which=things, sensors=st.sampled_from([{"bumper": 2}, {"cliff": 1}, {"bumper": 4}]))
    def bump_before(self, which, sensors):
        """Something touches the robot in front and will not let go, and behind it is what it saw."""
        self.back_into(which, 0.0, -0.7, 0.0)
        self.trial.sense(150, **sensors)

    @rule(button=st.booleans())
    def stop(self, button):
        self.trial.stop(button)

    @rule(seconds=st.sampled_from([0.1, 0.4, 2.0]))
    def hang(self, seconds):
        self.trial.hang(seconds)

    @rule()
    def restart(self):
        self.trial.restart()

    @rule(voids=ahead, posts=posts, dark=st.booleans(), linear=st.sampled_from([0.7, 0.2]), turn=asides)
    def carry(self, voids, posts, dark, linear, turn):
        """From where it looked around to another place, where it is driven on at once."""
        self.trial.drive(0.0, 1.5, 100)
        self.trial.dark = dark
        self.trial.carry((voids, posts))
        self.trial.drive(linear, turn, 60)

    @precondition(lambda self: self.trial.lost)
    @rule()
    def rescue(self):
        self.trial.carry()


TestGate = pytest.mark.slow(Gate.TestCase)
TestGate.settings = settings(
    max_examples=6,
    stateful_step_count=16,
    suppress_health_check=list(HealthCheck),
)
