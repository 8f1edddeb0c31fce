"""What the base shows, plays and switches on request."""

from collections.abc import Callable
from typing import Annotated, Literal

from pydantic import Field

from cliffscan.common.runtime.command_handlers import Answer, Request, done
from cliffscan.services.kobuki.protocol import commands
from cliffscan.services.kobuki.protocol.commands import LedColour, Outputs, SoundSequence, Supply

SUPPLIES = {"3.3V": Supply.V3_3, "5V": Supply.V5, "12V5A": Supply.V12_5A, "12V1.5A": Supply.V12_1A5}


class LedRequest(Request):
    """Which LED, and its colour."""

    led: Annotated[int, Field(ge=1, le=2)]
    colour: Literal["off", "red", "green", "orange"]


class SoundRequest(Request):
    """One of the base's melodies, or a tone."""

    sequence: Literal["on", "off", "recharge", "button", "error", "cleaning_start", "cleaning_end"] | None = None
    frequency: float = 0.0  # [Hz]
    duration: float = 0.0  # [s]


class OutputRequest(Request):
    """A digital output, 0 to 3, or an external supply, switched."""

    output: Annotated[int, Field(ge=0, le=3)] | None = None
    supply: Literal["3.3V", "5V", "12V5A", "12V1.5A"] | None = None
    on: bool


class Peripherals:
    """What the base shows, plays and switches; keeps the one word that all outputs share."""

    def __init__(self, write: Callable[[bytes], None]) -> None:
        self._write = write
        self._outputs = Outputs()

    def resend(self) -> None:
        """A base that was switched off has forgotten."""
        self._write(self._outputs.encode())

    def led(self, parameters: Answer) -> Answer:
        """Light an LED."""
        asked = LedRequest.model_validate(parameters)
        self._set(self._outputs.with_led(asked.led, LedColour[asked.colour.upper()]))
        return done(f"LED {asked.led} is {asked.colour}")

    def sound(self, parameters: Answer) -> Answer:
        """Play a melody or a tone."""
        asked = SoundRequest.model_validate(parameters)
        if asked.sequence:
            self._write(commands.sound_sequence(SoundSequence[asked.sequence.upper()]))
            return done(f"plays {asked.sequence}")
        self._write(commands.sound(asked.frequency, asked.duration))
        return done(f"plays {asked.frequency} Hz for {asked.duration} s")

    def digital_output(self, parameters: Answer) -> Answer:
        """Switch an output or a supply."""
        asked = OutputRequest.model_validate(parameters)
        if (asked.output is None) == (asked.supply is None):
            raise ValueError("expected either output or supply")
        state = "on" if asked.on else "off"
        if asked.supply is not None:
            self._set(self._outputs.with_supply(SUPPLIES[asked.supply], asked.on))
            return done(f"supply {asked.supply} is {state}")
        self._set(self._outputs.with_digital_output(asked.output or 0, asked.on))
        return done(f"digital output {asked.output} is {state}")

    def _set(self, outputs: Outputs) -> None:
        self._write(outputs.encode())
        self._outputs = outputs
