"""From commands to the wheels: the firmware's dead time, and the motors that it may cut."""

from collections import deque

from cliffscan.simulator.kobuki.drive import Drive
from cliffscan.simulator.kobuki.kinematics import REST, Wheels
from cliffscan.simulator.kobuki.ticker import SECOND


class Motors:
    """Hands set speeds to the drive, each a fixed time after it was commanded.

    The last one holds for ever. While cut, the motors are off; the set speed holds again afterwards.
    """

    def __init__(self, drive: Drive, dead_time: int) -> None:
        self.target = REST  # [m/s]
        self.cut = False
        self._drive = drive
        self._dead_time = dead_time  # [ns]
        self._clock = 0  # [ns]
        self._commanded: deque[tuple[int, Wheels]] = deque()

    def command(self, speeds: Wheels) -> None:
        """Make for these speeds [m/s] when the dead time has passed."""
        self._commanded.append((self._clock + self._dead_time, speeds))
        self._obey()

    def until(self) -> int:
        """Time [ns] to the next change of the set speed; a second where none is known."""
        return self._commanded[0][0] - self._clock if self._commanded else SECOND

    def advance(self, ns: int, cut: bool) -> None:
        """Let the wheels turn, at most up to the next change."""
        self.cut = cut
        if cut:
            self._drive.release()
        else:
            self._drive.command(self.target)
        self._drive.step(ns / SECOND)
        self._clock += ns
        self._obey()

    def _obey(self) -> None:
        while self._commanded and self._commanded[0][0] <= self._clock:
            self.target = self._commanded.popleft()[1]
