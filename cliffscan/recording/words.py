"""Sizes and times for people, in both directions."""

import math
import re
import sys

UNITS = {"k": 10**3, "M": 10**6, "G": 10**9}
SIZE = re.compile(r"([0-9]+(?:\.[0-9]+)?)([kMG]?)")


def size(count: float) -> str:
    """A number of bytes: 12.3 MB."""
    for unit, factor in reversed(UNITS.items()):
        if abs(count) >= factor:
            return f"{count / factor:.1f} {unit}B"
    return f"{count:.0f} B"


def parse_size(text: str) -> int:
    """A number of bytes, as 500M. Raises ValueError."""
    found = SIZE.fullmatch(text)
    if not found:
        raise ValueError(f"{text!r} is no size: a number of bytes, or one with k, M or G, as 500M")
    return round(float(found[1]) * UNITS.get(found[2], 1))


def duration(seconds: float) -> str:
    """A time span: 12.3 s, 5 min, 3 h, 4 days."""
    if seconds < 100.0:
        return f"{seconds:.1f} s"
    for unit, factor in (("min", 60.0), ("h", 3600.0)):
        if seconds < 100.0 * factor:
            return f"{seconds / factor:.0f} {unit}"
    return f"{seconds / 86400.0:.0f} days" if math.isfinite(seconds) else "ever"


def report(text: str) -> None:
    """Print a line for a person, beside what a program may read."""
    print(f"cliffscan: {text}", file=sys.stderr, flush=True)
