"""Scenes in which a safe gate keeps the robot from harm, and one with a planted fault does not."""

import math

import numpy as np
import pytest

from cliffscan.safety import visible_floor
from cliffscan.safety.gate import SafetyGate
from cliffscan.safety.local_grid import FREE, OCCUPIED, UNKNOWN, RollingGrid
from cliffscan.safety.pending_motion import PendingMotion
from cliffscan.safety.rules import Situation
from cliffscan.safety.velocity_limiter import NO_LIMIT, VelocityLimiter
from tests import gate_scenes as scenes
from tests import gate_trial
from tests.gate_drive import taken_at_its_word


def configured(**changes):
    """A gate that is given other figures than those of the robot."""
    return lambda patch: patch.setattr(gate_trial, "LIMITS", gate_trial.LIMITS._replace(**changes))


def wrapped(owner, name, instead):
    """A gate in which one function is another: instead(original, *arguments)."""
    original = getattr(owner, name)
    return lambda patch: patch.setattr(owner, name, lambda *arguments: instead(original, *arguments))


def _back_off_anyway(limit, it, side, wanted, age):
    return NO_LIMIT if age is None else limit(it, side, wanted, age)


def _forget_every_metre(follow, grid, pose, radius):
    if not hasattr(grid, "at") or math.hypot(pose.x - grid.at.x, pose.y - grid.at.y) >= 1.0:
        grid.at = pose
        grid._seen[grid._seen >= OCCUPIED] = UNKNOWN
    follow(grid, pose, radius)


def _free_where_forgotten(follow, grid, pose, radius):
    follow(grid, pose, radius)
    cells = grid._seen[grid._window(pose.x, pose.y, 0.35)]
    cells[cells == UNKNOWN] = FREE


MUTANTS = {
    "reaction of 0.05 s": (scenes.pass_a_post, configured(reaction=0.05)),
    "deceleration doubled": (scenes.charge, configured(deceleration=1.2)),
    "old scans accepted": (scenes.lose_sight, configured(scan_timeout=5.0)),
    "a silent driver obeyed": (scenes.lose_the_driver, configured(command_timeout=5.0)),
    "no blind zone": (scenes.charge, lambda patch: patch.setattr(visible_floor, "UNDESCRIBED_NEAREST", 0.0)),
    "a smaller robot": (scenes.pass_a_post, configured(radius=0.12)),
    "only straight on": (scenes.swerve_over_an_edge, wrapped(PendingMotion, "curvatures", lambda *_: [0.0])),
    "only the arc asked for": (
        scenes.swerve_into_a_post,
        wrapped(PendingMotion, "curvatures", lambda f, *a: f(*a)[:1]),
    ),
    "no pending motion": (scenes.swerve_into_a_post, wrapped(PendingMotion, "speed", lambda *_: 0.0)),
    "edges forgotten after 1 m": (scenes.pass_a_post, wrapped(RollingGrid, "follow", _forget_every_metre)),
    "free around the robot": (scenes.be_carried, wrapped(RollingGrid, "follow", _free_where_forgotten)),
    "not seen is free": (
        scenes.charge_into_the_dark,
        wrapped(RollingGrid, "see", lambda f, s, r, e, free, *a: f(s, r, e, np.where(np.isnan(r), np.inf, free), *a)),
    ),
    "what stands behind vouches for the floor before it": (
        scenes.charge_across_the_dark,
        wrapped(RollingGrid, "see", lambda f, s, r, e, _, *a: f(s, r, e, taken_at_its_word(r, 4.0), *a)),
    ),
    "not known is free": (
        scenes.charge_into_the_dark,
        wrapped(RollingGrid, "not_free", lambda f, s, p, r, _: f(s, p, r, False)),
    ),
    "scans where the robot is now": (
        scenes.charge,
        wrapped(SafetyGate, "see", lambda f, s, n, _, *a: f(s, n, s._pose, *a)),
    ),
    "what is behind ignored": (
        scenes.back_over_an_edge,
        wrapped(VelocityLimiter, "limit", lambda f, s, side, *a: f(s, side, *a) if side > 0 else NO_LIMIT),
    ),
    "backing off blindly": (scenes.bump_before_an_edge, wrapped(Situation, "limit", _back_off_anyway)),
    "the near approached": (scenes.pass_a_post, wrapped(VelocityLimiter, "_approach", lambda *_: 0.1)),
    "a carried robot's memory kept": (scenes.be_carried, wrapped(RollingGrid, "forget", lambda *_: None)),
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
