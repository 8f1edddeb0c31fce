"""Which services of a robot run on which of two hosts, and which of them drives the base."""

from typing import Literal

from cliffscan.common.runtime.config import BASES, SENSING

Part = Literal["robot", "workstation"]
ROBOT: Part = "robot"
WORKSTATION: Part = "workstation"
PERCEPTION = "perception"  # negative, positive and fuse in one process
SCANS = tuple(name for name in SENSING if name != "capture")
KOBUKI, GATE = "kobuki", "gate"
PORT = 7447  # on which routers listen, as Zenoh has it
REAL, NO_BASE = "real", "none"  # bases beside the names of services


def bases() -> list[str]:
    """What can be named as a base: a Kobuki, none, or the service of another one."""
    return [REAL, NO_BASE, *(name for name in BASES if name != KOBUKI)]


def services_of(part: Part | None, perception: bool) -> list[str]:
    """The services between camera and scan that a part has, all of them where it is None.

    perception: whether one process makes the scans. The workstation makes them otherwise, or else nobody would.
    """
    camera = [] if part == WORKSTATION else ["capture"]
    if perception:
        return [*camera, PERCEPTION]
    return camera if part == ROBOT else [*camera, *SCANS]


def listening(part: Part | None, secure: bool) -> str:
    """Where a router listens unless told: that of the robot's part for the workstation, any other for its own host."""
    protocol, host = "tls" if secure else "tcp", "0.0.0.0" if part == ROBOT else "127.0.0.1"  # noqa: S104
    return f"{protocol}/{host}:{PORT}"
