"""Results come in order from however many processes, and the line on the terminal tells how far they are."""

import math

import pytest

from evaluation.workers import LINES, counted, in_order


@pytest.mark.parametrize("jobs", [1, 2])
def test_results_come_in_the_order_of_the_work(jobs):
    warmed = []
    assert list(in_order(math.sqrt, [9, 4, 1], jobs, lambda: warmed.append(1))) == [3, 2, 1]
    assert warmed == [1] * (jobs > 1)


def test_all_results_are_handed_on_and_some_are_told(capsys):
    whole = 5 * LINES
    taken = []
    taken.extend(counted(range(whole), whole, lambda: f"{len(taken)} taken, "))
    assert taken == list(range(whole))
    lines = capsys.readouterr().err.splitlines()
    assert len(lines) == LINES
    assert lines[-1].startswith(f"{whole} of {whole}, {whole} taken, ")
