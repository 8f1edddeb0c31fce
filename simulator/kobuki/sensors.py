"""What the base's sensors report, beyond wheels and gyro. Anything may be set at any time; sensors saturate."""

from dataclasses import dataclass, field

BUMPER = {"right": 1, "centre": 2, "left": 4}
CLIFF = {"right": 1, "centre": 2, "left": 4}
WHEEL_DROP = {"right": 1, "left": 2}
OVERCURRENT = {"left": 1, "right": 2}
BUTTON = {"0": 1, "1": 2, "2": 4}
CHARGER = {"discharging": 0, "dock_charged": 2, "dock_charging": 6, "adapter_charged": 18, "adapter_charging": 22}
SIDES = ("right", "centre", "left")  # the order in which what looks ahead or down is told

FLAGS = {"bumper": BUMPER, "cliff": CLIFF, "wheel_drop": WHEEL_DROP, "overcurrent": OVERCURRENT, "button": BUTTON}

FLOOR_ADC = 2050  # of a cliff sensor above the floor, as real ones report about 1700 to 2050
DROP_ADC = 310  # of a cliff sensor with nothing below


@dataclass
class Sensors:
    """The state of everything that is sent in each packet. Flags have one bit for each sensor, as in the tables."""

    bumper: int = 0
    cliff: int = 0
    wheel_drop: int = 0
    overcurrent: int = 0
    button: int = 0
    charger: int = 0
    battery: float = 16.4  # [V]
    dock_ir: dict[str, int] = field(default_factory=lambda: dict.fromkeys(CLIFF, 0))  # bits of the beams each sees
    cliff_adc: dict[str, int] = field(default_factory=lambda: dict.fromkeys(CLIFF, FLOOR_ADC))  # 0 to 4095
    current: dict[str, float] = field(default_factory=lambda: {"left": 0.01, "right": 0.01})  # [A] of each motor
    digital_input: int = 0  # bits 0 to 3
    analog_input: list[int] = field(default_factory=lambda: [0, 0, 0, 0])  # 0 to 4095

    def flag(self, sensor: str, which: str, on: bool) -> None:
        """Set one flag, as `flag("bumper", "left", True)`. Raises KeyError for one that does not exist."""
        bit = FLAGS[sensor][which]
        state: int = getattr(self, sensor)
        setattr(self, sensor, state | bit if on else state & ~bit)
        if sensor == "cliff":
            self.cliff_adc[which] = DROP_ADC if on else FLOOR_ADC
