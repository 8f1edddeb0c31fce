"""Versions of firmware and hardware, what they can do, and how they name themselves."""

import re
import struct
from dataclasses import dataclass
from typing import NamedTuple, Self


class Version(NamedTuple):
    """Major, minor, patch, as in 1.2.0."""

    major: int
    minor: int
    patch: int

    @classmethod
    def parse(cls, text: str) -> Self:
        """Read `1.2.0`. Raises ValueError for anything else."""
        if not re.fullmatch(r"\d{1,3}\.\d{1,3}\.\d{1,3}", text) or max(parts := [*map(int, text.split("."))]) > 255:
            raise ValueError(f"{text!r} is no version: expected three numbers up to 255, as in 1.2.0")
        return cls(*parts)

    def __str__(self) -> str:
        return f"{self.major}.{self.minor}.{self.patch}"


NEWEST = Version(1, 2, 0)
HARDWARE = Version(1, 0, 4)
FIRST_WITH_LENGTHS = Version(1, 0, 0)  # sub-payloads tell their length, and raw gyro samples are sent
FIRST_WITH_LONG_VERSIONS = Version(1, 1, 2)  # a version is told in four bytes
FIRST_WITH_GAINS = Version(1, 2, 0)

FACTORY_CODE = 123  # what 1.0.0 says of itself; its successors say 110 and 111


@dataclass(frozen=True)
class Identity:
    """What a base says about itself when asked."""

    firmware: Version = NEWEST
    hardware: Version = HARDWARE
    udid: tuple[int, int, int] = (20130830, 1000, 1)  # unique among all bases; 3 × 32 bits


def version_bytes(version: Version, firmware: Version) -> bytes:
    """How a base with this firmware tells a version: patch, minor, major, 0; before 1.1.2 a decimal code."""
    if firmware >= FIRST_WITH_LONG_VERSIONS:
        return bytes([version.patch, version.minor, version.major, 0])
    return struct.pack("<H", 100 * version.major + 10 * version.minor + version.patch)


def firmware_bytes(firmware: Version) -> bytes:
    """How a firmware tells its own version."""
    if firmware == FIRST_WITH_LENGTHS:
        return struct.pack("<H", FACTORY_CODE)
    return version_bytes(firmware, firmware)
