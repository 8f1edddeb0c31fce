"""The gyro: a heading since power-on, its rate, and the raw samples of its three axes."""

import math

from cliffscan.simulator.kobuki.drive import Drive, Rates
from cliffscan.simulator.kobuki.feedback import Triple
from cliffscan.simulator.kobuki.ticker import Ticker

PERIOD = 9_615_384  # [ns] 104 Hz, as users measure it: a packet of 20 ms holds 2 samples, every thirteenth 3
DIGIT = math.radians(0.00875)  # [rad/s] of a raw sample
HUNDREDTH = math.radians(0.01)  # [rad] of the heading, [rad/s] of its rate
INT16 = 0x7FFF


class Gyro:
    """Watches how a body turns, from the moment it is switched on."""

    def __init__(self, drive: Drive) -> None:
        self._drive = drive
        self._start = drive.pose.theta
        self._first = 0
        self._samples: list[Triple] = []
        self._ticker = Ticker(PERIOD)

    def until(self) -> int:
        """Time [ns] to the next sample."""
        return self._ticker.left

    def advance(self, ns: int) -> None:
        """Let time pass, at most up to the next sample."""
        if self._ticker.advance(ns):
            self._samples.append(raw(self._drive.rates))

    def angle(self) -> int:
        """Heading [0.01°] since power-on, wrapped to -18000 to 18000."""
        return round(math.remainder(self._drive.pose.theta - self._start, math.tau) / HUNDREDTH)

    def rate(self) -> int:
        """Rate of the heading [0.01°/s]."""
        return saturated(self._drive.rates.yaw / HUNDREDTH)

    def take(self) -> tuple[int, list[Triple]]:
        """The number of the first sample since the last time, and these samples."""
        first, samples = self._first, self._samples
        self._first, self._samples = (first + len(samples)) % 256, []
        return first, samples


def raw(rates: Rates) -> Triple:
    """A sample in the sensor's own axes, which stand a quarter turn from the robot's: x is its pitch, -y its roll."""
    return (saturated(rates.pitch / DIGIT), saturated(-rates.roll / DIGIT), saturated(rates.yaw / DIGIT))


def saturated(value: float) -> int:
    """The nearest number that 16 bits can tell."""
    return max(-INT16 - 1, min(INT16, round(value)))
