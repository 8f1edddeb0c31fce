"""Sizes and times for people."""

import math

import pytest

from cliffscan.recording.words import duration, parse_size, size


@pytest.mark.parametrize(
    ("count", "text"), [(0, "0 B"), (999, "999 B"), (1000, "1.0 kB"), (12_345_678, "12.3 MB"), (-5e9, "-5.0 GB")]
)
def test_size(count, text):
    assert size(count) == text


@pytest.mark.parametrize(
    ("text", "count"), [("0", 0), ("17", 17), ("500M", 500_000_000), ("1.5k", 1500), ("2G", 2 * 10**9)]
)
def test_parse_size(text, count):
    assert parse_size(text) == count


@pytest.mark.parametrize("text", ["", "M", "-1", "5MB", "1e9", "5 M"])
def test_what_is_no_size_is_refused(text):
    with pytest.raises(ValueError, match="is no size: a number of bytes"):
        parse_size(text)


@pytest.mark.parametrize(
    ("seconds", "text"), [(12.34, "12.3 s"), (300, "5 min"), (4 * 3600, "4 h"), (9e5, "10 days"), (math.inf, "ever")]
)
def test_duration(seconds, text):
    assert duration(seconds) == text
