"""What the doctor found: a line each."""

from enum import Enum
from typing import NamedTuple


class Level(Enum):
    """How bad a finding is."""

    OK = "ok"
    WARNING = "warning"  # it works, and not as it should
    FAULT = "fault"  # the robot does not drive, or not safely


class Finding(NamedTuple):
    """A line: what was looked at, and what was found; one that is not OK ends with the remedy."""

    level: Level
    subject: str
    text: str


def ok(subject: str, text: str) -> Finding:
    """All is well."""
    return Finding(Level.OK, subject, text)


def warning(subject: str, text: str) -> Finding:
    """It works, and not as it should."""
    return Finding(Level.WARNING, subject, text)


def fault(subject: str, text: str) -> Finding:
    """The robot does not drive like this, or not safely."""
    return Finding(Level.FAULT, subject, text)


def worst(findings: list[Finding]) -> Level:
    """The worst level of all, OK where there is none."""
    levels = [finding.level for finding in findings]
    return next((level for level in (Level.FAULT, Level.WARNING) if level in levels), Level.OK)
