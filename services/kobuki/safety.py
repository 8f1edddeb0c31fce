"""The gate between every command and the wheels.

It has no clock and no port: times [s] are arguments, on one clock that does not go back. What it lets pass is a
function of what it was told and of the time, and every doubt stops the robot.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from common.base_messages import Rule
from services.kobuki.config import KobukiConfig
from services.kobuki.ground import HALF_CELL, LOOK, Floats, Ground, Pose
from services.kobuki.path import SLOW, Momentum, free_distance, safe_speed
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
        self._ground = Ground(pose, config.start_free)
        self._momentum = Momentum(config.reaction, config.deceleration)
        self.latched = ""  # why the emergency stop holds, or nothing
        self.restart(pose)

    def restart(self, pose: Pose) -> None:
        """Nobody knows what happened since: the robot stands on floor, and what was in its way may still be there."""
        self._ground.begin_again(pose, self._config.start_free)
        self._momentum.rest()
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
        """Somebody wants the robot to move; what is no number asks for nothing."""
        if all(map(math.isfinite, asked)):
            self._asked, self._asked_at = asked, now

    def see(self, scan: Scan, pose: Pose, taken: float, now: float) -> None:
        """A fused scan came, taken at `taken` [s] by a robot at `pose`; one that was overtaken is of no use."""
        taken = min(taken, now)  # no clock that is ahead may make later scans look fresh
        if taken < self._scan_taken:
            return
        self._scan_taken, self._scan_came = taken, now
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
        self._momentum.send(*decision.allowed, now)
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
        if reaction.pressed:
            self._ground.touch(touched(reaction.hit, self._pose, self._config.robot_radius))
        return Decision(reaction.hit.kind, Twist(reaction.linear, reaction.angular), self._asked, note=reaction.note)

    def _driving(self, asked: Twist, now: float) -> Decision:
        """What is left of a command."""
        config = self._config
        if now - self._asked_at > config.command_timeout:
            return Decision("no_command", REST, asked)
        age = max(now - min(self._scan_taken, self._scan_came), 0.0)
        fresh = age <= config.scan_timeout
        if config.require_scan and not fresh:
            note = f"last scan {age:.1f} s old" if age < math.inf else "no scan yet"
            return Decision("no_scan", self._slow_turn(asked.angular, now), asked, note=note)
        return self._before_obstacle(self._ramped(self._limited(asked), now), asked, age if fresh else None, now)

    def _slow_turn(self, angular: float, now: float) -> Twist:
        """What is left of a command to a blind robot: it stops on its arc, and then may turn slowly."""
        if max(self._momentum.speed(side, now) for side in (1, -1)) > SLOW:
            return REST
        slow = math.radians(self._config.slow_turn)
        return self._ramped(Twist(0.0, min(max(angular, -slow), slow)), now)

    def _limited(self, asked: Twist) -> Twist:
        """No faster than the base may be, on the same arc."""
        fastest = math.radians(self._config.max_angular)
        excess = max(abs(asked.linear) / self._config.max_linear, abs(asked.angular) / fastest, 1.0)
        return asked.scaled(1.0 / excess)

    def _ramped(self, wanted: Twist, now: float) -> Twist:
        """No farther from what was last allowed than an acceleration takes it; to slow down is always allowed.

        A robot that starts keeps to the arc that was asked for; one that drives already is not slowed down to turn.
        """
        step = min(max(now - self._decided_at, 0.0), LONGEST_STEP)
        before = self._before
        linear = _toward(before.linear, wanted.linear, self._config.acceleration * step)
        part = min(linear / wanted.linear, 1.0) if linear * wanted.linear > 0.0 else 1.0
        angular = _toward(before.angular, wanted.angular * part, math.radians(self._config.angular_acceleration) * step)
        if abs(linear) > abs(before.linear) and abs(angular) < abs(wanted.angular * part):
            on_arc = linear * abs(angular / (wanted.angular * part))
            linear = math.copysign(max(abs(on_arc), min(abs(before.linear), abs(linear))), linear)
        return Twist(linear, angular)

    def _before_obstacle(self, wanted: Twist, asked: Twist, age: float | None, now: float) -> Decision:
        """So fast that the robot can brake before it touches anything, by a scan `age` [s] old or by none.

        While it still goes on from before, faster than it could brake on the new arc, it brakes first and turns then.
        A turn on the spot touches nothing new.
        """
        factor, nearest = 1.0, math.inf
        for side in (1, -1):
            asks, drift = max(side * wanted.linear, 0.0), self._momentum.speed(side, now)
            if asks == 0.0 and (drift <= SLOW or wanted.angular == 0.0):
                continue
            curvatures = self._momentum.curvatures(side, *wanted, now)
            latency = self._config.reaction + (age or 0.0)
            distance = self._free_distance(side * max(asks, drift), curvatures, latency, unseen_too=age is not None)
            fastest = safe_speed(distance, self._config.deceleration, latency)
            swerves = len(curvatures) > 1 and drift > max(fastest, SLOW)
            if swerves or asks > fastest:
                factor, nearest = min(factor, 0.0 if swerves else fastest / asks), min(nearest, distance)
        if factor < 1.0:
            return Decision("obstacle", wanted.scaled(factor), asked, nearest)
        return Decision("free" if wanted == asked else "limit", wanted, asked)

    def _free_distance(self, linear: float, curvatures: list[float], latency: float, unseen_too: bool) -> float:
        """How far [m] the robot can go on the worst of these arcs [1/m]; beyond what braking takes nobody looks."""
        config = self._config
        radius = config.robot_radius + config.margin + HALF_CELL
        braking = abs(linear) * latency + linear**2 / (2.0 * config.deceleration)
        reach = min(radius + braking + 0.1, LOOK)
        # what lies behind is not seen, and backing away must stay possible: only what is known to be there counts
        points = self._ground.not_free(self._pose, reach, unknown_too=unseen_too and linear > 0.0)
        if not points.size:
            return reach - radius
        distances = [free_distance(points, linear, linear * curvature, radius) for curvature in curvatures]
        return min([*distances, reach - radius])


def _toward(before: float, wanted: float, step: float) -> float:
    """From one speed towards another: slower at once, faster or the other way round by `step` at most."""
    start = before if before * wanted > 0.0 else 0.0
    if abs(wanted) <= abs(start):
        return wanted
    return math.copysign(min(abs(start) + step, abs(wanted)), wanted)
