"""What two records, of a robot and of a workstation, come to."""

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from cliffscan.common.contract import topics

Record = dict[str, Any]  # as benchmarks/link/probe.py writes it
NO_SCAN = "no_scan"


class Figures(NamedTuple):
    """Of one run. Times [s]; shares of 1."""

    rate: float  # [Hz] fused scans at the robot
    median: float  # age of a fused scan that arrives there
    percentile99: float
    gap: float  # longest time without one
    no_scan: float  # of the time, in which the gate held the robot for want of a fresh scan
    odometry_lost: float  # on the way to the workstation
    odometry_late: float  # age of the median that arrives there
    doubled: int  # fused scans of a frame that had one
    up: float  # [bytes/s] from the robot


def figures(robot: Record, workstation: Record, began: int, ended: int, up: int) -> Figures:
    """The figures of the time from `began` to `ended` [ns], in which `up` bytes came from the robot."""
    seconds = (ended - began) * 1e-9
    fused = _within(robot[topics.SCAN_FUSED.path], began, ended)
    ages = (fused[:, 1] - fused[:, 0]) * 1e-9
    path = topics.ODOMETRY.path
    sent = _within(robot[path], began, ended)[:, 0]
    came = np.array(workstation[path], np.int64).reshape(-1, 2)
    arrived = came[np.isin(came[:, 0], sent)]
    gaps = np.diff(np.concatenate([[began], fused[:, 1], [ended]])) * 1e-9
    return Figures(
        rate=len(fused) / seconds,
        median=_percentile(ages, 50),
        percentile99=_percentile(ages, 99),
        gap=float(gaps.max()),
        no_scan=share_of(robot[topics.SAFETY.path], NO_SCAN, began, ended),
        odometry_lost=1.0 - float(np.isin(sent, came[:, 0]).mean()) if len(sent) else float("nan"),
        odometry_late=_percentile((arrived[:, 1] - arrived[:, 0]) * 1e-9, 50),
        doubled=len(fused) - len(np.unique(fused[:, 0])),
        up=up / seconds,
    )


def share_of(rules: Sequence[tuple[int, str]], rule: str, began: int, ended: int) -> float:
    """The share of the time from `began` to `ended` in which a rule held; rules: since when which does, in order."""
    ends = [at for at, _ in rules[1:]] + [ended]
    held = [
        max(0, min(end, ended) - max(at, began)) for (at, name), end in zip(rules, ends, strict=False) if name == rule
    ]
    return sum(held) / (ended - began)


def _within(came: Sequence[tuple[int, int]], began: int, ended: int) -> Any:  # noqa: ANN401
    """(n, 2) stamps and arrivals [ns] of what arrived in that time."""
    pairs = np.array(came, np.int64).reshape(-1, 2)
    return pairs[(pairs[:, 1] >= began) & (pairs[:, 1] < ended)]


def _percentile(values: Any, share: float) -> float:  # noqa: ANN401
    return float(np.percentile(values, share)) if len(values) else float("nan")
