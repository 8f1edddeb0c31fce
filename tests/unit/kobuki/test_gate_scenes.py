"""Scenes in which a safe gate keeps the robot from harm, and one with a planted fault does not."""

import math

import numpy as np
import pytest

from cliffscan.safety import velocity_limiter as foresight
from cliffscan.safety.gate import Decision, Safety, Twist
from cliffscan.safety.local_grid import FREE, OCCUPIED, UNKNOWN, Ground
from cliffscan.safety.pending_motion import Momentum
from cliffscan.safety.velocity_limiter import Foresight
from cliffscan.services.kobuki.config import KobukiConfig
from tests import kobuki_scenes as scenes
from tests import kobuki_trial
from tests.kobuki_gate import taken_at_its_word


def configured(**changes):
    """A gate that was told other figures than those of the robot."""
    return lambda patch: patch.setattr(kobuki_trial, "KobukiConfig", lambda: KobukiConfig(**changes))


def wrapped(owner, name, instead):
    """A gate in which one function is another: instead(original, *arguments)."""
    original = getattr(owner, name)
    return lambda patch: patch.setattr(owner, name, lambda *arguments: instead(original, *arguments))


def _back_off_anyway(_, safety, reaction, limit):
    return Decision(reaction.hit.kind, Twist(-0.1, 0.0), safety._asked)


def _forget_every_metre(follow, ground, pose, radius):
    if not hasattr(ground, "at") or math.hypot(pose.x - ground.at.x, pose.y - ground.at.y) >= 1.0:
        ground.at = pose
        ground._state[ground._state >= OCCUPIED] = UNKNOWN
    follow(ground, pose, radius)


def _free_where_forgotten(follow, ground, pose, radius):
    follow(ground, pose, radius)
    cells = ground._state[ground._window(pose.x, pose.y, 0.35)]
    cells[cells == UNKNOWN] = FREE


MUTANTS = {
    "reaction of 0.05 s": (scenes.pass_a_post, configured(reaction=0.05)),
    "deceleration doubled": (scenes.charge, configured(deceleration=1.2)),
    "old scans accepted": (scenes.lose_sight, configured(scan_timeout=5.0)),
    "a silent driver obeyed": (scenes.lose_the_driver, configured(command_timeout=5.0)),
    "no blind zone": (scenes.charge, configured(blind=0.0)),
    "a smaller robot": (scenes.pass_a_post, configured(robot_radius=0.12)),
    "only straight on": (scenes.swerve_over_an_edge, wrapped(Momentum, "curvatures", lambda *_: [0.0])),
    "only the arc asked for": (scenes.swerve_into_a_post, wrapped(Momentum, "curvatures", lambda f, *a: f(*a)[:1])),
    "no momentum": (scenes.swerve_into_a_post, wrapped(Momentum, "speed", lambda *_: 0.0)),
    "edges forgotten after 1 m": (scenes.pass_a_post, wrapped(Ground, "follow", _forget_every_metre)),
    "free around the robot": (scenes.be_carried, wrapped(Ground, "follow", _free_where_forgotten)),
    "not seen is free": (
        scenes.charge_into_the_dark,
        wrapped(Ground, "see", lambda f, s, r, e, free, *a: f(s, r, e, np.where(np.isnan(r), np.inf, free), *a)),
    ),
    "what stands behind vouches for the floor before it": (
        scenes.charge_across_the_dark,
        wrapped(Ground, "see", lambda f, s, r, e, _, *a: f(s, r, e, taken_at_its_word(r, 4.0), *a)),
    ),
    "not known is free": (
        scenes.charge_into_the_dark,
        wrapped(Ground, "not_free", lambda f, s, p, r, _: f(s, p, r, False)),
    ),
    "scans where the robot is now": (
        scenes.charge,
        wrapped(Safety, "see", lambda f, s, n, _, *a: f(s, n, s._pose, *a)),
    ),
    "what is behind ignored": (
        scenes.back_over_an_edge,
        wrapped(Foresight, "limit", lambda f, s, side, *a: f(s, side, *a) if side > 0 else foresight.NONE),
    ),
    "backing off blindly": (scenes.bump_before_an_edge, wrapped(Safety, "_cornered", _back_off_anyway)),
    "the near approached": (scenes.pass_a_post, wrapped(Foresight, "_approach", lambda *_: 0.1)),
    "a carried robot's memory kept": (scenes.be_carried, wrapped(Ground, "forget", lambda *_: None)),
}


@pytest.mark.parametrize(
    "scene",
    [
        scenes.charge,
        scenes.charge_into_the_dark,
        scenes.charge_across_the_dark,
        scenes.pass_a_post,
        scenes.come_back_to_a_post,
        scenes.lose_sight,
        scenes.lose_the_driver,
        scenes.swerve_over_an_edge,
        scenes.swerve_into_a_post,
        scenes.spin_and_go,
        scenes.look_while_spinning,
        scenes.be_carried,
        scenes.back_over_an_edge,
        scenes.bump_before_an_edge,
        scenes.creep_up_to_an_edge,
    ],
)
def test_a_safe_gate_comes_to_no_harm(scene):
    scene()


@pytest.mark.parametrize(("scene", "plant"), MUTANTS.values(), ids=MUTANTS)
def test_a_planted_fault_is_found(scene, plant, monkeypatch):
    plant(monkeypatch)
    with pytest.raises(AssertionError):
        scene()
