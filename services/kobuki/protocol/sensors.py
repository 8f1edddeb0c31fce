"""What the Kobuki measures: a type for each sub-payload of its feedback. Source: Kobuki protocol.

Everything is in SI units but what has none: encoder ticks, motor PWM, the ADC counts of the cliff sensors, and the
base's own clock, which counts 16 bits of milliseconds.
"""

from enum import CONFORM, IntEnum, IntFlag
from typing import NamedTuple, Self

GYRO_PERIOD = 10_000_000  # [ns] between two samples of the gyro
VOLTS_PER_COUNT = 3.3 / 4095  # of every 12-bit ADC


class Bumper(IntFlag, boundary=CONFORM):
    """Bumpers pressed."""

    RIGHT = 1
    CENTRE = 2
    LEFT = 4


class WheelDrop(IntFlag, boundary=CONFORM):
    """Wheels hanging in the air."""

    RIGHT = 1
    LEFT = 2


class Cliff(IntFlag, boundary=CONFORM):
    """Cliff sensors that see no floor."""

    RIGHT = 1
    CENTRE = 2
    LEFT = 4


class Button(IntFlag, boundary=CONFORM):
    """Buttons pressed."""

    B0 = 1
    B1 = 2
    B2 = 4


class Overcurrent(IntFlag, boundary=CONFORM):
    """Wheel motors that draw more than 3 A; the other way round than the wheel drops."""

    LEFT = 1
    RIGHT = 2


class DockSignal(IntFlag, boundary=CONFORM):
    """Regions of the docking station whose beam an infrared receiver sees."""

    NEAR_LEFT = 1
    NEAR_CENTRE = 2
    NEAR_RIGHT = 4
    FAR_CENTRE = 8
    FAR_LEFT = 16
    FAR_RIGHT = 32


class Charger(IntEnum):
    """Where the battery's current comes from."""

    UNKNOWN = -1
    DISCHARGING = 0
    DOCK_CHARGED = 2
    DOCK_CHARGING = 6
    ADAPTER_CHARGED = 18
    ADAPTER_CHARGING = 22

    @classmethod
    def _missing_(cls, value: object) -> Self:  # noqa: ARG003  (the protocol may grow)
        return cls.UNKNOWN

    @property
    def charging(self) -> bool:
        """Whether the battery is being charged now."""
        return self in (Charger.DOCK_CHARGING, Charger.ADAPTER_CHARGING)

    @property
    def charged(self) -> bool:
        """Whether the battery is on a charger and full."""
        return self in (Charger.DOCK_CHARGED, Charger.ADAPTER_CHARGED)


class GainSet(IntEnum):
    """Which gains the wheel controller works with."""

    FACTORY = 0
    USER = 1


class Core(NamedTuple):
    """What every packet of a living base holds."""

    timestamp: int  # [ms] of the base's clock, wraps at 65536
    bumper: Bumper
    wheel_drop: WheelDrop
    cliff: Cliff
    left_encoder: int  # [ticks], wraps at 65536
    right_encoder: int
    left_pwm: int  # -128 ... 127, negative backwards
    right_pwm: int
    buttons: Button
    charger: Charger
    battery: float  # [V]
    overcurrent: Overcurrent


class DockIr(NamedTuple):
    """What the three receivers see of the docking station."""

    right: DockSignal
    centre: DockSignal
    left: DockSignal


class Inertia(NamedTuple):
    """The heading as the base integrates it, counter-clockwise, and its rate."""

    angle: float  # [rad], -π ... π, arbitrary zero
    rate: float  # [rad/s]


class CliffCounts(NamedTuple):
    """Raw cliff sensors: ADC counts 0 ... 4095, not linear in the distance; times VOLTS_PER_COUNT they are volts."""

    right: int
    centre: int
    left: int


class MotorCurrent(NamedTuple):
    """Currents of the wheel motors [A]."""

    left: float
    right: float


class AngularRate(NamedTuple):
    """Angular rates [rad/s] about the robot's axes: x forward, y left, z up."""

    x: float
    y: float
    z: float


class Gyro(NamedTuple):
    """Samples of the gyro since the last packet, oldest first."""

    frame_id: int  # of the first sample, wraps at 256
    samples: tuple[AngularRate, ...]

    def stamps(self, now: int) -> tuple[int, ...]:
        """When each sample was taken [ns], for a packet that came at `now` [ns]."""
        return tuple(range(now - GYRO_PERIOD * (len(self.samples) - 1), now + 1, GYRO_PERIOD))


class GpInput(NamedTuple):
    """The general-purpose inputs."""

    digital: tuple[bool, bool, bool, bool]
    analog: tuple[float, float, float, float]  # [V]


class Udid(NamedTuple):
    """The base's unique number, three words."""

    first: int
    second: int
    third: int

    def __str__(self) -> str:
        return f"{self.first}-{self.second}-{self.third}"


class Gains(NamedTuple):
    """The wheel controller's gains."""

    kind: GainSet
    p: float
    i: float
    d: float
