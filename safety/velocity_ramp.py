"""From what was allowed last to what is wanted now: no faster than the base may be, no sooner than it may get there."""

import math
from typing import NamedTuple

from cliffscan.safety.inputs import SafetyLimits, Twist

LONGEST_INCREMENT = 0.1  # [s] for which an acceleration is given at once


class VelocityRamp(NamedTuple):
    """The velocity that was allowed last, and how long ago."""

    limits: SafetyLimits
    before: Twist
    seconds: float  # since then

    def limited(self, asked: Twist) -> Twist:
        """No faster than the base may be, on the same arc."""
        excess = max(abs(asked.linear) / self.limits.max_linear, abs(asked.angular) / self.limits.max_angular, 1.0)
        return asked.scaled(1.0 / excess)

    def toward(self, wanted: Twist) -> Twist:
        """No farther from what was last allowed than an acceleration takes it; to slow down is always allowed.

        A robot that starts keeps to the arc that was asked for; one that drives already is not slowed down to turn, and
        one that turns already goes on turning.
        """
        step = min(max(self.seconds, 0.0), LONGEST_INCREMENT)
        before = self.before
        linear = _toward(before.linear, wanted.linear, self.limits.acceleration * step)
        part = min(linear / wanted.linear, 1.0) if linear * wanted.linear > 0.0 else 1.0
        if before.angular * wanted.angular > 0.0:
            part = max(part, min(before.angular / wanted.angular, 1.0))
        angular = _toward(before.angular, wanted.angular * part, self.limits.angular_acceleration * step)
        if abs(linear) > abs(before.linear) and abs(angular) < abs(wanted.angular * part):
            on_arc = linear * abs(angular / (wanted.angular * part))
            linear = math.copysign(max(abs(on_arc), min(abs(before.linear), abs(linear))), linear)
        return Twist(linear, angular)


def _toward(before: float, wanted: float, step: float) -> float:
    """From one speed towards another: slower at once, faster or the other way round by `step` at most."""
    start = before if before * wanted > 0.0 else 0.0
    if abs(wanted) <= abs(start):
        return wanted
    return math.copysign(min(abs(start) + step, abs(wanted)), wanted)
