"""What could go wrong with the gate, played: each scene ends well with a gate that is safe."""

import math

from tests.gate_trial import Trial

DEAD, LATE = 0.23, 0.12  # [s] the base's and the scans', at their worst


def trial(voids=(), posts=(), late=LATE, dark=False):
    return Trial(list(voids), list(posts), DEAD, late, dark)


def charge():
    """At full speed towards an edge, straight on and aslant."""
    for aside in (0.0, 0.4):
        trial([(aside, 2.2)]).drive(0.7, 0.0, 250)


def charge_into_the_dark():
    """Towards a hole that no beam shows."""
    for far in (0.8, 1.6):
        trial([(0.0, far)], dark=True).drive(0.7, 0.0, 200)


def charge_across_the_dark():
    """Towards something that stands behind a hole no beam shows."""
    for far in (0.8, 1.6):
        trial([(0.0, far)], [(0.0, far + 0.6, 1.5)], dark=True).drive(0.7, 0.0, 200)


def pass_a_post():
    """It comes into the blind zone, where beams pass it, and out of memory's sight for a while."""
    for aside in (-0.1, 0.0, 0.1):
        one = trial(posts=[(aside, 1.6, 0.03)])
        one.drive(0.3, 0.0, 150)
        one.drive(0.7, 0.0, 100)


def come_back_to_a_post():
    """It was seen more than 1 m ago, and the robot is back before it with its eyes elsewhere."""
    one = trial(posts=[(0.0, 0.8, 0.05)])
    one.drive(0.0, 0.0, 20)
    one.face(math.pi / 2)
    one.drive(0.5, 0.0, 140)
    one.drive(-0.5, 0.0, 160)
    one.face(0.0)
    one.drive(0.4, 0.0, 100)


def lose_sight():
    """Scans end, or the same comes for ever, while the robot goes on."""
    for how in ({"scans": False}, {"scans": False, "frozen": True}):
        one = trial()
        one.drive(0.5, 0.0, 40)
        one.run(60, **how)


def lose_the_driver():
    """Commands end while the robot goes on."""
    one = trial()
    one.drive(0.5, 0.0, 40)
    one.run(60, commands=False)


def swerve_over_an_edge():
    """Alongside an edge at full speed, and then round towards it on an arc."""
    for beside in (0.4, 0.5, 0.7):
        for linear, turn in ((0.7, 1.9), (0.7, 1.0), (0.5, 1.9)):
            _alongside(beside).drive(linear, -turn, 80)


def _alongside(beside):
    """A robot at full speed with an edge on its right."""
    one = trial([(-math.pi / 2, beside)])
    one.face(-math.pi / 2)
    one.face(0.0)
    one.drive(0.7, 0.0, 70)
    return one


def swerve_into_a_post():
    """Past a post at full speed, and just before it round towards it: what was sent before carries the robot on."""
    for ticks in (129, 132, 135, 138):
        for linear in (0.05, 0.2):
            one = trial(posts=[(-0.185, 1.63, 0.03)])
            one.drive(0.7, 0.0, ticks)
            one.drive(linear, -1.9, 70)


def spin_and_go():
    """The robot still turns when it begins to go."""
    for ticks in range(50, 100, 6):
        one = trial([(0.3, 0.75)], [(-0.8, 0.5, 0.1)])
        one.drive(0.0, 1.9, ticks)
        one.drive(0.7, 0.0, 60)
        one.drive(0.0, -1.9, ticks)
        one.drive(0.7, 0.0, 60)


def look_while_spinning():
    """Scans come late, of a robot that turns fast."""
    for turn in (1.9, -1.9):
        one = trial([(0.0, 1.1)], [(0.6, 1.0, 0.05), (-0.6, 1.0, 0.05)])
        for _ in range(2):
            one.drive(0.0, turn, 115)
        for way in (0.0, 0.6, -0.6):
            one.face(way)
            one.drive(0.7, 0.0, 80)


def be_carried():
    """From floor that was looked at to where a hole begins in the blind zone, or in the dark."""
    for far, dark in ((0.6, False), (0.9, True), (0.6, True)):
        one = trial()
        one.drive(0.0, 1.9, 180)
        one.drive(0.0, 0.0, 10)
        one.dark = dark
        one.carry(([(0.0, far)], []))
        one.drive(0.3, 0.0, 100)
        one.drive(0.7, 0.5, 60)


def back_over_an_edge():
    """What was seen is behind: by command, and by a bumper that does not let go."""
    for aside in (0.0, 0.5):
        for pressed in (False, True):
            one = trial([(0.0, 0.9)])
            one.drive(0.0, 0.0, 20)
            one.face(math.pi + aside)
            one.drive(-0.7, 0.0, 100)
            if pressed:
                one.sense(200, bumper=2)


def bump_before_an_edge():
    """A sensor does not let go while the robot backs off towards what it saw."""
    for sensors in ({"bumper": 2}, {"cliff": 1}):
        one = trial([(0.0, 0.85)])
        one.drive(0.3, 0.0, 100)
        one.face(math.pi)
        one.sense(300, **sensors)


def creep_up_to_an_edge():
    """Turning and going on again and again, it comes no nearer."""
    for bearing in (0.0, 0.3):
        one = trial([(bearing, 0.8)])
        for _ in range(6):
            one.drive(0.7, 0.0, 60)
            one.drive(0.3, 1.0, 25)
            one.drive(0.3, -1.0, 25)
