"""The gate between every command and the wheels.

It has no clock and no port: times [s] are arguments, on one clock that does not go back. What it lets pass is a
function of what it was told and of the time, and every doubt stops the robot.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from cliffscan.common.contract.base_messages import Rule
from cliffscan.common.contract.description import CameraDescription
from cliffscan.common.contract.evidence import EDGES
from cliffscan.common.contract.messages import LaserScan
from cliffscan.safety.approach_monitor import ApproachMonitor, Glance
from cliffscan.safety.contact_recovery import Reaction, Reflex, touched
from cliffscan.safety.local_grid import Floats, Ground, Pose
from cliffscan.safety.scan_claims import View
from cliffscan.safety.velocity_limiter import Foresight, Limit, Obstruction
from cliffscan.services.kobuki.config import KobukiConfig
from cliffscan.services.kobuki.protocol.sensors import Button, Core, WheelDrop

LONGEST_STEP = 0.1  # [s] for which an acceleration is given at once
DOUBTED = 1.0  # [s] for which an odometry that contradicted itself is not driven by
CRAWL = 0.02  # [m/s] below which a robot that is held back turns on the spot
BOTH_WHEELS = WheelDrop.LEFT | WheelDrop.RIGHT
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
    distance: float = NOTHING  # [m] the robot can go
    note: str = ""
    obstruction: Obstruction | None = None


class Scan(NamedTuple):
    """A fused scan: (beams,) each."""

    ranges: Floats  # [m] as REP-117 has them
    edges: NDArray[np.bool_]  # whether a number is where the floor ends
    free: Floats  # [m] how far floor was seen
    angles: Floats  # [rad] evenly spaced

    @classmethod
    def of(cls, scan: LaserScan, view: View) -> Scan:
        """What a message tells; it frees no more than the view, nor what it says in one breath not to have seen."""
        ranges, angles = scan.ranges.astype(np.float64), scan.grid().angles()
        edges = np.isin(scan.intensities, EDGES) if len(scan.intensities) else np.zeros(len(ranges), np.bool_)
        free = scan.free()
        free[np.isnan(ranges) & (free >= scan.range_max)] = 0.0
        return cls(ranges, edges, view.within(free, angles), angles)


class Safety:
    """What is known, and what follows from it for the wheels."""

    def __init__(self, config: KobukiConfig, pose: Pose) -> None:
        self._config = config
        self._reflex = Reflex()
        self._ground = Ground(pose, config.start_free)
        self._foresight = Foresight(config, self._ground)
        self._decided_at = -math.inf
        self._approach = ApproachMonitor()
        self.view = View.undescribed(config.blind)  # what scans may claim to see
        self.latched = ""  # why the emergency stop holds, or nothing
        self.distrusted = ""  # why the odometry is not believed until clear(), or nothing
        self._doubt, self._doubted_until = "", -math.inf
        self.restart(pose)

    def restart(self, pose: Pose) -> None:
        """Nobody knows what happened since: the robot stands on floor, and what was in its way may still be there."""
        self._ground.begin_again(pose, self._config.start_free)
        self._foresight.rest()
        self._reflex.clear()
        self._approach.begin()
        self._pose = pose
        self._core: Core | None = None
        self._lost = ""  # why the base is not heard
        self._tilted, self._carried = False, False
        self._asked, self._asked_at = REST, -math.inf
        self._scan_taken = self._scan_came = -math.inf
        self._blind_until = self._decided_at  # [s]; a scan taken before is of a place that nobody knows
        self._before, self._decided_at = REST, -math.inf

    def describe(self, camera: CameraDescription) -> None:
        """The camera says what it can see."""
        self.view = View.of(camera, self._config.blind)

    def lose_base(self, why: str = "") -> None:
        """The base has fallen silent."""
        self._core, self._lost = None, why

    def stop(self, why: str) -> None:
        """The emergency stop; it holds until clear()."""
        self.latched = why

    def distrust(self, why: str) -> None:
        """The odometry is wrong; the robot stands still until clear()."""
        self.distrusted = self.distrusted or why

    def doubt(self, why: str, now: float) -> None:
        """The odometry may have been wrong for a moment; the robot stands still for as long as it takes to tell."""
        self._doubt, self._doubted_until = why, now + DOUBTED

    def clear(self) -> None:
        """Let go of the emergency stop, of a distrusted odometry, and of what bumpers and cliff sensors told."""
        self.latched = self.distrusted = ""
        self._approach.begin()
        self._reflex.clear()
        self._ground.forgive()

    def command(self, asked: Twist, now: float) -> None:
        """Somebody wants the robot to move; what is no number asks for nothing."""
        if all(map(math.isfinite, asked)):
            self._asked, self._asked_at = asked, now

    def see(self, scan: Scan, pose: Pose, taken: float, now: float) -> None:
        """A fused scan came, taken at `taken` [s] by a robot at `pose`.

        One that was overtaken frees nothing, for what it shows may have changed, but what it shows in the way counts:
        no scan that claims to be of the future keeps an honest one out. One taken with a wheel in the air is of no use.
        """
        taken = min(taken, now)
        if self._tilted or taken <= self._blind_until:
            return
        camera = pose.then(self._config.camera())
        if taken < self._scan_taken:
            self._ground.mark(scan.ranges, scan.edges, scan.angles, camera)
            return
        self._scan_taken, self._scan_came = taken, now
        self._ground.see(*scan, camera, self.view.nearest)
        if wrong := self._approach.see(Glance(scan.ranges, scan.angles, camera, taken)):
            self.distrust(wrong)

    def sense(self, core: Core, pose: Pose) -> None:
        """A packet of the base came, and the robot is at `pose` now."""
        self._core, self._pose = core, pose
        self._ground.follow(pose, self._config.robot_radius)
        if core.buttons & Button.B0:
            self.stop("button B0")

    def decide(self, now: float) -> Decision:
        """What goes to the wheels at `now`. To be asked at every packet and at every command."""
        asked = self._asked
        decision = self._overriding(now) or self._driving(asked, now)
        self._before, self._decided_at = decision.allowed, now
        self._foresight.send(*decision.allowed, now)
        return decision

    def _overriding(self, now: float) -> Decision | None:
        """The rules that hold whatever was asked, the strongest first."""
        core = self._core
        if core is None:
            return Decision("no_base", REST, self._asked, note=self._lost)
        self._feel(core, now)
        reaction = self._reflex.update(core, self._pose)
        if self.latched:
            return Decision("stopped", REST, self._asked, note=self.latched)
        if core.wheel_drop:
            return Decision("wheel_drop", REST, self._asked)
        if core.overcurrent:
            return Decision("overcurrent", REST, self._asked)
        if self.distrusted:
            return Decision("odometry", REST, self._asked, note=f"{self.distrusted}; holds until clear_safety")
        if now < self._doubted_until:
            return Decision("odometry", REST, self._asked, note=self._doubt)
        return self._backing_off(reaction, now) if reaction else None

    def _feel(self, core: Core, now: float) -> None:
        """With one wheel in the air the camera is tilted; with both the robot is carried to where nobody knows."""
        self._carried |= core.wheel_drop == BOTH_WHEELS
        if self._tilted and not core.wheel_drop:
            self._blind_until = now
            if self._carried:
                self._ground.forget()
                self._ground.follow(self._pose, self._config.robot_radius)
            self._carried = False
        self._tilted = bool(core.wheel_drop)

    def _backing_off(self, reaction: Reaction, now: float) -> Decision | None:
        """What a sensor makes the robot do, as far as nothing is remembered behind it."""
        hit, linear, angular, note, pressed = reaction
        if pressed:
            self._ground.touch(touched(hit, self._pose, self._config.robot_radius))
        if linear < 0.0:
            limit = self._foresight.limit(-1, linear, angular, self._pose, None, now)
            linear *= limit.factor
            if -linear < CRAWL:
                return self._cornered(reaction, limit)
        return Decision(hit.kind, Twist(linear, angular), self._asked, note=note)

    def _cornered(self, reaction: Reaction, limit: Limit) -> Decision | None:
        """Something is behind: the robot stays until it is let go, and then has backed off far enough."""
        if not reaction.pressed:
            self._reflex.clear()
            return None
        return Decision(reaction.hit.kind, REST, self._asked, limit.distance, "something is behind")

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
        if not self._foresight.stands(now):
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

        A robot that starts keeps to the arc that was asked for; one that drives already is not slowed down to turn, and
        one that turns already goes on turning.
        """
        step = min(max(now - self._decided_at, 0.0), LONGEST_STEP)
        before = self._before
        linear = _toward(before.linear, wanted.linear, self._config.acceleration * step)
        part = min(linear / wanted.linear, 1.0) if linear * wanted.linear > 0.0 else 1.0
        if before.angular * wanted.angular > 0.0:
            part = max(part, min(before.angular / wanted.angular, 1.0))
        angular = _toward(before.angular, wanted.angular * part, math.radians(self._config.angular_acceleration) * step)
        if abs(linear) > abs(before.linear) and abs(angular) < abs(wanted.angular * part):
            on_arc = linear * abs(angular / (wanted.angular * part))
            linear = math.copysign(max(abs(on_arc), min(abs(before.linear), abs(linear))), linear)
        return Twist(linear, angular)

    def _before_obstacle(self, wanted: Twist, asked: Twist, age: float | None, now: float) -> Decision:
        """So fast that the robot can brake before it touches anything, by a scan `age` [s] old or by none."""
        limits = [self._foresight.limit(side, *wanted, self._pose, age, now) for side in (1, -1)]
        factor = min(limit.factor for limit in limits)
        if factor < 1.0:
            slower = self._held(wanted.scaled(factor), asked, now)
            nearest = min(limits, key=lambda limit: limit.distance)
            return Decision("obstacle", slower, asked, nearest.distance, obstruction=nearest.obstruction)
        return Decision("free" if wanted == asked else "limit", wanted, asked)

    def _held(self, slower: Twist, asked: Twist, now: float) -> Twist:
        """Slower on the same arc; but a robot that can hardly go on turns on the spot, which touches nothing new."""
        if abs(slower.linear) >= CRAWL or not self._foresight.stands(now):
            return slower
        return self._ramped(Twist(0.0, self._limited(asked).angular), now)


def _toward(before: float, wanted: float, step: float) -> float:
    """From one speed towards another: slower at once, faster or the other way round by `step` at most."""
    start = before if before * wanted > 0.0 else 0.0
    if abs(wanted) <= abs(start):
        return wanted
    return math.copysign(min(abs(start) + step, abs(wanted)), wanted)
