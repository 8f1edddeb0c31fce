"""What is going on in a base, as JSON can tell it."""

from dataclasses import asdict

from cliffscan.simulator.kobuki.base import Base
from cliffscan.simulator.kobuki.commands import Command
from cliffscan.simulator.kobuki.firmware import Firmware

Fields = dict[str, object]

SUPPLIES = {"3.3V": 0x10, "5V": 0x20, "12V5A": 0x40, "12V1.5A": 0x80}
LED_COLOURS = ("off", "red", "green", "orange")
FIRST_LED, SECOND_LED = 8, 10  # the lower one of each LED's two bits
DIGITAL = 0x0F


def report(base: Base) -> Fields:
    """Everything: what the base was told, what it does with it, and where it truly is. Lengths [m], times [s]."""
    firmware = base.firmware
    return {
        "time": firmware.time,
        "uptime": firmware.uptime,
        "firmware": str(firmware.identity.firmware),
        "powered": firmware.powered,
        "plugged": base.plugged,
        "connected": base.connected,
        "packets": firmware.packets,
        "discarded": firmware.discarded,
        "received": received(firmware),
        "output": output(firmware.output),
        "gains": firmware.gains._asdict(),
        "target": firmware.motors.target._asdict(),
        "motors_cut": firmware.motors.cut,
        "speeds": firmware.drive.speeds._asdict(),
        "travelled": firmware.drive.travelled._asdict(),
        "truth": firmware.drive.pose._asdict(),
        "sensors": asdict(firmware.sensors),
    }


def received(firmware: Firmware) -> Fields:
    """The last command of each kind, when it came and how many of its kind did."""
    heard = firmware.received
    return {
        name: {"time": heard.time[name], "count": heard.count[name], **fields(command)}
        for name, command in heard.last.items()
    }


def fields(command: Command) -> Fields:
    """What a command says."""
    told = {name: value.hex() if isinstance(value, bytes) else value for name, value in vars(command).items()}
    return {"command": command.name, **told}


def output(word: int) -> Fields:
    """The word of all outputs, spelled out."""
    return {
        "word": word,
        "digital": word & DIGITAL,
        "supplies": {name: bool(word & bit) for name, bit in SUPPLIES.items()},
        "leds": [LED_COLOURS[word >> lowest & 3] for lowest in (FIRST_LED, SECOND_LED)],
    }
