"""Faults on demand: one-line commands, as `bumper left on`."""

import json
import math
from collections.abc import Callable
from dataclasses import replace

from cliffscan.simulator.kobuki.base import Base
from cliffscan.simulator.kobuki.drive import RampedWheels
from cliffscan.simulator.kobuki.kinematics import Wheels
from cliffscan.simulator.kobuki.report import report
from cliffscan.simulator.kobuki.sensors import CHARGER
from cliffscan.simulator.kobuki.versions import Version

Handler = Callable[[Base, list[str]], None]

ON = {"on": True, "press": True, "off": False, "release": False}
SIDES3, SIDES2 = "left|centre|right", "left|right"
CHARGERS = "|".join(CHARGER)


class ControlError(ValueError):
    """A line that is no command, or one that this base cannot obey."""


def execute(base: Base, line: str) -> str:
    """Obey one line; the answer: `ok`, or what was asked for. Raises ControlError, saying what was expected."""
    name, *words = line.split() or [""]
    if name == "state":
        return json.dumps(report(base))
    if name == "help":
        return "; ".join(["state", "watch", *(f"{name} {usage}" for name, (usage, _) in COMMANDS.items())])
    if name not in COMMANDS:
        raise ControlError(f"no command is named {name!r}; `help` tells which there are")
    usage, handler = COMMANDS[name]
    if not fits(words, usage.split()):
        raise ControlError(f"expected {name} {usage}")
    try:
        handler(base, words)
    except ValueError as error:
        raise ControlError(f"{name}: {error}") from error
    return "ok"


def fits(words: list[str], usage: list[str]) -> bool:
    """Whether words are what a usage says: alternatives a|b, NUMBERs, a VERSION, the last ones [optional]."""
    required = [choice for choice in usage if not choice.startswith("[")]
    if not len(required) <= len(words) <= len(usage):
        return False
    return all(_fits(word, choice.strip("[]")) for word, choice in zip(words, usage, strict=False))


def _fits(word: str, choice: str) -> bool:
    if not choice.isupper():
        return word in choice.split("|")
    return choice == "VERSION" or is_number(word)


def is_number(word: str) -> bool:
    """Whether a word is a finite number."""
    try:
        return math.isfinite(float(word))
    except ValueError:
        return False


def whole(word: str) -> int:
    """A word as a whole number. Raises ValueError for one below 0 or with a fraction."""
    value = float(word)
    if value < 0 or not value.is_integer():
        raise ValueError(f"{word}, expected a whole number of 0 or more")
    return int(value)


def flag(sensor: str) -> Handler:
    """A handler that sets one of a sensor's flags."""

    def handler(base: Base, words: list[str]) -> None:
        base.firmware.sensors.flag(sensor, words[0], ON[words[1]])

    return handler


def slip(base: Base, words: list[str]) -> None:
    """Have the wheels lose another share of their way."""
    wheels = base.firmware.drive
    if not isinstance(wheels, RampedWheels):
        raise ControlError("these wheels slip as their own world has them")
    left, right, *noise = map(float, words)
    wheels.model = replace(wheels.model, slip=Wheels(left, right), noise=noise[0] if noise else wheels.model.noise)


def encoders(base: Base, words: list[str]) -> None:
    """Have the encoders count a share of the wheels' way."""
    firmware = base.firmware
    firmware.encoders.count(Wheels(float(words[0]), float(words[1])), firmware.drive.travelled)


def clock(base: Base, words: list[str]) -> None:
    """Stop the base's own time, or let it go on."""
    base.firmware.clock_stands = not ON[words[0]]


def reading(sensor: str, read: Callable[[str], object]) -> Handler:
    """A handler that sets what a sensor reads; where there are several, of the one that is named first."""

    def handler(base: Base, words: list[str]) -> None:
        *which, value = words
        if which:
            getattr(base.firmware.sensors, sensor)[which[0]] = read(value)
        else:
            setattr(base.firmware.sensors, sensor, read(value))

    return handler


def analog_input(base: Base, words: list[str]) -> None:
    """Set one analog input."""
    base.firmware.sensors.analog_input[int(words[0])] = whole(words[1])


COMMANDS: dict[str, tuple[str, Handler]] = {
    "bumper": (f"{SIDES3} on|off", flag("bumper")),
    "cliff": (f"{SIDES3} on|off", flag("cliff")),
    "wheel_drop": (f"{SIDES2} on|off", flag("wheel_drop")),
    "overcurrent": (f"{SIDES2} on|off", flag("overcurrent")),
    "button": ("0|1|2 press|release", flag("button")),
    "battery": ("VOLTS", reading("battery", float)),
    "charger": (CHARGERS, reading("charger", CHARGER.get)),
    "current": (f"{SIDES2} AMPERES", reading("current", float)),
    "cliff_adc": (f"{SIDES3} READING", reading("cliff_adc", whole)),
    "dock_ir": (f"{SIDES3} BEAMS", reading("dock_ir", whole)),
    "digital_input": ("BITS", reading("digital_input", lambda word: whole(word) & 0xFFFF)),
    "analog_input": ("0|1|2|3 READING", analog_input),
    "slip": ("LEFT RIGHT [NOISE]", slip),
    "encoders": ("LEFT RIGHT", encoders),
    "clock": ("on|off", clock),
    "slow": ("BYTES_A_SECOND", lambda base, words: base.line.slow(float(words[0]))),
    "repeat": ("on|off", lambda base, words: base.line.repeat(ON[words[0]])),
    "unplug": ("SECONDS", lambda base, words: base.unplug(float(words[0]))),
    "power_cycle": ("[SECONDS]", lambda base, words: base.firmware.power_cycle(*map(float, words))),
    "firmware": ("VERSION", lambda base, words: base.firmware.flash(Version.parse(words[0]))),
    "skip": ("SECONDS", lambda base, words: base.firmware.skip(float(words[0]))),
    "pause": ("SECONDS", lambda base, words: base.line.pause(float(words[0]))),
    "garbage": ("COUNT", lambda base, words: base.line.garbage(whole(words[0]))),
    "corrupt": ("COUNT", lambda base, words: base.line.corrupt(whole(words[0]))),
    "cut": ("SIZE", lambda base, words: base.line.cut(whole(words[0]))),
}
