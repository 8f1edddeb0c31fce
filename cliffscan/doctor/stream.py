"""What was received on one key: how often, how much, and what is missing of it."""

from typing import NamedTuple

import numpy as np


class Arrival(NamedTuple):
    """A sample. seq is -1 where its message has none; times [ns]: by the writer's clock, by this machine's."""

    seq: int
    stamp: int
    at: int
    size: int  # [bytes]


class Stream(NamedTuple):
    """A key over a few seconds."""

    rate: float  # [Hz]
    bytes_per_second: float
    lost: float  # share of the sequence numbers between the first and the last that did not come; 0 without any
    jitter: float  # [s] by which the slowest of a hundred samples is slower than the quickest


def measure(arrivals: list[Arrival]) -> Stream:
    """The figures of the samples of a key in the order in which they came; all zero for fewer than two."""
    if len(arrivals) < 2:
        return Stream(0.0, 0.0, 0.0, 0.0)
    seqs = np.array([each.seq for each in arrivals], object)  # the contract's go beyond int64
    stamps, times, sizes = np.array([each[1:] for each in arrivals], np.int64).T
    ways = times - stamps
    seconds = max((times[-1] - times[0]) * 1e-9, 1e-9)
    steps = np.diff(seqs)
    forward = steps[steps > 0]  # a writer that starts again begins again
    lost = float((forward - 1).sum() / forward.sum()) if len(forward) else 0.0
    jitter = float(np.percentile(ways, 99) - ways.min()) * 1e-9
    return Stream((len(arrivals) - 1) / seconds, float(sizes[1:].sum()) / seconds, lost, jitter)
