"""Which Kobukis this software can drive, and what the owners of others should do. Source: Kobuki protocol, driver."""

from typing import NamedTuple


class Version(NamedTuple):
    """A version of firmware or hardware; versions compare as one would expect."""

    major: int
    minor: int
    patch: int

    def __str__(self) -> str:
        return f"{self.major}.{self.minor}.{self.patch}"


UNREPORTED = Version(0, 0, 0)  # firmware before 1.0.0 cannot be asked; its packets give it away
MAJOR = 1
RECOMMENDED = (Version(1, 1, 4), Version(1, 2, 0))
GAINS_SINCE = Version(1, 2, 0)
HELP = "see https://kobuki.readthedocs.io/en/devel/firmware.html"

OLD_FIRMWARE_CODES = {
    123: Version(1, 0, 0),
    110: Version(1, 1, 0),
    111: Version(1, 1, 1),
    10100: Version(1, 1, 0),
    10101: Version(1, 1, 1),
}  # of the first releases, which reported their version in two bytes
OLD_HARDWARE_CODES = {104: Version(1, 0, 4)}


def refusal(firmware: Version, hardware: Version | None) -> str | None:
    """Why a base must not be driven, or None where it may be. hardware: None where it did not report it."""
    name = _name(firmware, hardware)
    if firmware.major < MAJOR:
        return f"{name} is older than 1.0.0 and cannot be driven: put firmware {RECOMMENDED[-1]} on the base, {HELP}"
    if firmware.major > MAJOR:
        known = f"this software knows {MAJOR}.x only"
        return f"{name} cannot be driven, {known}: upgrade the software, or the base to {RECOMMENDED[-1]}, {HELP}"
    return None


def advice(firmware: Version, hardware: Version | None) -> str | None:
    """What the owner of a base that may be driven should do about its version, if anything."""
    name = _name(firmware, hardware)
    if firmware in RECOMMENDED:
        return None
    if firmware > RECOMMENDED[-1]:
        return f"{name} is newer than {RECOMMENDED[-1]}: upgrade the software"
    recommended = " or ".join(map(str, RECOMMENDED))
    return f"{name} is not the recommended {recommended}: replace the firmware, {HELP}"


def has_gains(firmware: Version) -> bool:
    """Whether the base lets its wheel controller's gains be read and set."""
    return firmware >= GAINS_SINCE


def _name(firmware: Version, hardware: Version | None) -> str:
    name = (
        f"firmware {firmware}" if firmware != UNREPORTED else "firmware that sends packets without sub-payload lengths"
    )
    return name if hardware is None else f"{name} (hardware {hardware})"
