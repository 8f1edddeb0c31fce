"""The gate between every command and the wheels.

It has no clock and no port: times [s] are arguments, on one clock that does not go back. What it lets pass is a
function of what it was told and of the time, and every doubt stops the robot.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from common.base_messages import Rule
from services.kobuki.config import KobukiConfig
from services.kobuki.ground import HALF_CELL, LOOK, TOUCHED, Floats, Ground, Pose
from services.kobuki.path import free_distance, safe_speed
from services.kobuki.reflex import Reflex, touched
from services.kobuki.sensors import Button, Core

LONGEST_STEP = 0.1  # [s] for which an acceleration is given at once
NOTHING = -1.0  # [m] where no obstacle holds the robot back


class Twist(NamedTuple):
    """A velocity: linear [m/s] forward, angular [rad/s] counter-clockwise."""

    linear: float
    angular: float

    def scaled(self, factor: float) -> Twist:
        """The same arc at another speed."""
        return Twist(self.linear * factor, self.angular * factor)


REST = Twist(0.0, 0.0)


class Decision(NamedTuple):
    """What goes to the wheels, and why."""

    rule: Rule
    allowed: Twist
    asked: Twist
    distance: float = NOTHING  # [m]
    note: str = ""


class Scan(NamedTuple):
    """A fused scan: ranges (beams,) [m] as REP-117 has them at evenly spaced angles [rad]."""

    ranges: Floats
    angles: Floats
    range_max: float


class Safety:
    """What is known, and what follows from it for the wheels."""

    def __init__(self, config: KobukiConfig, pose: Pose) -> None:
        self._config = config
        self._reflex = Reflex()
        self.latched = ""  # why the emergency stop holds, or nothing
        self.restart(pose)

    def restart(self, pose: Pose) -> None:
        """Nobody knows what happened since: what was seen is forgotten, and the robot is taken to stand on floor."""
        self._ground = Ground(pose, self._config.start_free)
        self._reflex.clear()
        self._pose = pose
        self._core: Core | None = None
        self._asked, self._asked_at = REST, -math.inf
        self._scan_taken = self._scan_came = -math.inf
        self._before, self._decided_at = REST, -math.inf

    def lose_base(self) -> None:
        """The base has fallen silent."""
        self._core = None

    def stop(self, why: str) -> None:
        """The emergency stop; it holds until clear()."""
        self.latched = why

    def clear(self) -> None:
        """Let go of the emergency stop and of what bumpers and cliff sensors told."""
        self.latched = ""
        self._reflex.clear()
        self._ground.forgive()

    def command(self, asked: Twist, now: float) -> None:
        """Somebody wants the robot to move."""
        self._asked, self._asked_at = asked, now

    def see(self, scan: Scan, pose: Pose, taken: float, now: float) -> None:
        """A fused scan came, taken at `taken` [s] by a robot at `pose`."""
        self._scan_taken, self._scan_came = max(taken, self._scan_taken), now
        camera = pose.then(self._config.camera())
        self._ground.see(scan.ranges, scan.angles, scan.range_max, camera, self._config.blind)

    def sense(self, core: Core, pose: Pose) -> None:
        """A packet of the base came, and the robot is at `pose` now."""
        self._core, self._pose = core, pose
        self._ground.follow(pose, self._config.robot_radius)
        if core.buttons & Button.B0:
            self.stop("button B0")

    def decide(self, now: float) -> Decision:
        """What goes to the wheels at `now`. To be asked at every packet and at every command."""
        asked = self._asked
        decision = self._overriding() or self._driving(asked, now)
        self._before, self._decided_at = decision.allowed, now
        return decision

    def _overriding(self) -> Decision | None:
        """The rules that hold whatever was asked, the strongest first."""
        core = self._core
        if core is None:
            return Decision("no_base", REST, self._asked)
        reaction = self._reflex.update(core, self._pose)
        if self.latched:
            return Decision("stopped", REST, self._asked, note=self.latched)
        if core.wheel_drop:
            return Decision("wheel_drop", REST, self._asked)
        if core.overcurrent:
            return Decision("overcurrent", REST, self._asked)
        if reaction is None:
            return None
        self._ground.mark(touched(reaction.hit, self._pose, self._config.robot_radius), TOUCHED)
        return Decision(reaction.hit.kind, Twist(reaction.linear, reaction.angular), self._asked, note=reaction.note)

    def _driving(self, asked: Twist, now: float) -> Decision:
        """What is left of a command."""
        config = self._config
        if now - self._asked_at > config.command_timeout:
            return Decision("no_command", REST, asked)
        wanted = self._ramped(self._limited(asked), now)
        age = now - min(self._scan_taken, self._scan_came)
        if config.require_scan and age > config.scan_timeout:
            slow = math.radians(config.slow_turn)
            turn = Twist(0.0, min(max(wanted.angular, -slow), slow))
            return Decision(
                "no_scan", turn, asked, note=f"last scan {age:.1f} s old" if age < math.inf else "no scan yet"
            )
        return self._before_obstacle(wanted, asked, max(age, 0.0) if config.require_scan else 0.0)

    def _limited(self, asked: Twist) -> Twist:
        """No faster than the base may be, on the same arc."""
        fastest = math.radians(self._config.max_angular)
        excess = max(abs(asked.linear) / self._config.max_linear, abs(asked.angular) / fastest, 1.0)
        return asked.scaled(1.0 / excess)

    def _ramped(self, wanted: Twist, now: float) -> Twist:
        """No farther from what was last allowed than an acceleration takes it; to slow down is always allowed."""
        step = min(max(now - self._decided_at, 0.0), LONGEST_STEP)
        before = self._before
        linear = _toward(before.linear, wanted.linear, self._config.acceleration * step)
        angular = _toward(before.angular, wanted.angular, math.radians(self._config.angular_acceleration) * step)
        if abs(wanted.linear) > 0.0 and abs(linear) < abs(wanted.linear):
            return Twist(linear, wanted.angular * linear / wanted.linear)  # on the arc that was asked for
        return Twist(linear, angular)

    def _before_obstacle(self, wanted: Twist, asked: Twist, age: float) -> Decision:
        """So fast that the robot can brake before it touches anything; a turn on the spot touches nothing new."""
        rule: Rule = "free" if wanted == asked else "limit"
        if wanted.linear == 0.0:
            return Decision(rule, wanted, asked)
        config = self._config
        latency = config.reaction + age
        radius = config.robot_radius + config.margin + HALF_CELL
        braking = abs(wanted.linear) * latency + wanted.linear**2 / (2.0 * config.deceleration)
        # what lies behind is not seen, and backing away must stay possible: only what is known to be there counts
        points = self._ground.not_free(self._pose, min(radius + braking + 0.1, LOOK), unknown_too=wanted.linear > 0.0)
        distance = free_distance(points, *wanted, radius)
        fastest = safe_speed(distance, config.deceleration, latency) if distance < math.inf else math.inf
        if abs(wanted.linear) <= fastest:
            return Decision(rule, wanted, asked)
        return Decision("obstacle", wanted.scaled(fastest / abs(wanted.linear)), asked, distance)


def _toward(before: float, wanted: float, step: float) -> float:
    """From one speed towards another: slower at once, faster or the other way round by `step` at most."""
    start = before if before * wanted > 0.0 else 0.0
    if abs(wanted) <= abs(start):
        return wanted
    return math.copysign(min(abs(start) + step, abs(wanted)), wanted)
