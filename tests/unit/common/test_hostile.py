"""Thousands of messages that nobody should send cost nothing but themselves."""

import time

import pytest

from tests.hostile import cases
from tests.hostile_readers import Readers

LONGEST = 0.5  # [s] of this thread's own time; a second and more before there were limits


def cost(readers, case):
    """The time of this thread [s], and whether the case was taken."""
    began = time.thread_time()
    good = readers.take(case)
    return time.thread_time() - began, good


@pytest.mark.parametrize("seed", range(4))
def test_whatever_comes_is_refused_or_harmless_and_soon_done(seed):
    readers, taken = Readers(), 0
    for case in cases(0, 30):
        readers.take(case)  # compiles
    for number, case in enumerate(cases(seed, 800)):
        seconds, good = cost(readers, case)
        if seconds >= LONGEST:  # it may have compiled: what it costs is what it costs again
            seconds, _ = cost(readers, case)
        assert seconds < LONGEST, f"{case.kind.__name__}, number {number}"
        taken += good
    assert 200 < taken < 700  # else they are too good, or too bad to get anywhere
