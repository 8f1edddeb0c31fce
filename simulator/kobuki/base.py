"""A base with its cable: the firmware, the line, and the plug."""

from cliffscan.simulator.kobuki.commands import Command
from cliffscan.simulator.kobuki.firmware import Firmware
from cliffscan.simulator.kobuki.line import Line
from cliffscan.simulator.kobuki.ticker import SECOND, nanoseconds


class Base:
    """What hangs on a driver's port. Stepped by its owner; it has no clock and no port itself."""

    def __init__(self, firmware: Firmware | None = None, line: Line | None = None) -> None:
        self.firmware = firmware or Firmware()
        self.line = line or Line()
        self.connected = False  # whether a driver has the port open, as far as the port's owner knows
        self._unplugged = 0  # [ns]

    @property
    def plugged(self) -> bool:
        """False while the cable is out."""
        return self._unplugged == 0

    def unplug(self, seconds: float) -> None:
        """Pull the cable out, and put it back in later. The base knows nothing of it and goes on.

        Raises ValueError for a span that is negative or not finite.
        """
        self._unplugged = nanoseconds(seconds)

    def receive(self, data: bytes) -> list[Command]:
        """Hear bytes from the driver. The commands that are complete with them, already obeyed."""
        return self.firmware.receive(data) if self.plugged else []

    def step(self, dt: float) -> list[bytes]:
        """Let time pass [s]; what the driver gets to read, piece by piece."""
        pieces = self.line.carry(self.firmware.step(dt), dt)
        if self.plugged:
            return pieces
        self._unplugged = max(0, self._unplugged - nanoseconds(dt))
        return []

    def until_next(self) -> float:
        """Time [s] after which the base may have something to say, or its plug to come back."""
        packet = self.firmware.until_packet()
        return packet if self.plugged else min(packet, self._unplugged / SECOND)
