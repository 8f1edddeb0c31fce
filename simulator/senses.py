"""What the base feels of the world: bumpers from contacts, cliff sensors from rays, wheel drops from the springs."""

import math
from typing import NamedTuple

from cliffscan.simulator.body import Body
from cliffscan.simulator.kobuki.sensors import DROP_ADC, FLOOR_ADC, Sensors

CENTRE = math.radians(25.0)  # a push from within this angle of ahead is the centre bumper's
LAST = math.radians(90.0)  # behind this there is no bumper
CLIFF_EYES = {  # [m] where the sensors look down from
    "right": (0.085, -0.136, 0.0214),
    "centre": (0.156, 0.0, 0.0214),
    "left": (0.087, 0.136, 0.0214),
}
FLOOR_DISTANCE = 0.0214  # [m] from an eye to a level floor
CLIFF_DISTANCE = 0.06  # [m] from an eye, beyond which it tells a cliff
DROPPED = 0.007  # [m] a wheel hangs down when its switch opens; its spring goes to 8 mm
ADC_STEP = 8  # a reading is told again when it has changed by so much


class Feeling(NamedTuple):
    """What is felt at one moment, and whether anything pushes the hull from any side.

    bumpers: those pushed; drops: the wheels dropped; depths: how far each cliff sensor sees [m].
    """

    bumped: bool
    bumpers: frozenset[str]
    drops: frozenset[str]
    depths: dict[str, float]


def feel(body: Body) -> Feeling:
    """What a body feels now."""
    drops = frozenset(side for side, droop in body.droop._asdict().items() if droop > DROPPED)
    pushes = body.contacts().tolist()
    bumpers = frozenset(side for angle in pushes if (side := bumper(angle)))
    return Feeling(bool(pushes), bumpers, drops, {side: body.below(eye) for side, eye in CLIFF_EYES.items()})


def bumper(angle: float) -> str:
    """The bumper that a push from a direction [rad] closes; none for one from behind."""
    if abs(angle) <= CENTRE:
        return "centre"
    if abs(angle) > LAST:
        return ""
    return "left" if angle > 0.0 else "right"


def cliff_adc(depth: float) -> int:
    """A cliff sensor's reading of a surface at a distance [m]: an infrared sensor's, that falls with its inverse."""
    return round(DROP_ADC + (FLOOR_ADC - DROP_ADC) * min(1.0, FLOOR_DISTANCE / max(depth, 1e-3)))


class Reporter:
    """Hands what is felt to a base's sensors; only what changes, so that a fault set by hand stays until then."""

    def __init__(self) -> None:
        self._flags: dict[tuple[str, str], bool] = {}
        self._readings = dict.fromkeys(CLIFF_EYES, FLOOR_ADC)

    def report(self, felt: Feeling, sensors: Sensors) -> None:
        """Update the sensors."""
        for side, depth in felt.depths.items():
            self._flag(sensors, "bumper", side, side in felt.bumpers)
            self._flag(sensors, "cliff", side, depth > CLIFF_DISTANCE)
            self._read(sensors, side, cliff_adc(depth))
        for side in ("right", "left"):
            self._flag(sensors, "wheel_drop", side, side in felt.drops)

    def _flag(self, sensors: Sensors, sensor: str, side: str, on: bool) -> None:
        if self._flags.get((sensor, side), False) != on:
            self._flags[sensor, side] = on
            sensors.flag(sensor, side, on)

    def _read(self, sensors: Sensors, side: str, reading: int) -> None:
        if abs(reading - self._readings[side]) >= ADC_STEP:
            self._readings[side] = sensors.cliff_adc[side] = reading
