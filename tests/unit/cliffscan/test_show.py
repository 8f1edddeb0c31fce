"""A message is one line of JSON; long arrays are told in a few words."""

import json
import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from cliffscan.common.contract.messages import DepthImage, LaserScan, ServiceStatus
from cliffscan.show import line
from tests import build
from tests.build import scan

INF, NAN = math.inf, math.nan
MESSAGES = [
    DepthImage.decode(build.payload(build.depth_fields())),
    LaserScan.decode(build.payload(build.scan_fields())),
    ServiceStatus.decode(build.payload(build.status_fields())),
]


def strict(text):
    """JSON as other programs read it: without NaN and Infinity."""

    def refuse(constant):
        raise ValueError(f"{constant} is no JSON")

    return json.loads(text, parse_constant=refuse)


@pytest.mark.parametrize("message", MESSAGES, ids=lambda message: type(message).__name__)
@pytest.mark.parametrize("full", [False, True])
def test_a_message_is_one_line_with_all_its_fields(message, full):
    text = line(message, full)
    assert "\n" not in text
    assert list(json.loads(text)) == list(type(message).model_fields)


@pytest.mark.parametrize(
    ("ranges", "words"),
    [
        ([1.5, 2.25, 0.5], "3 numbers from 0.500 to 2.250"),
        ([1.5, INF, NAN, INF], "1 numbers from 1.500 to 1.500, 2 inf, 1 nan"),
        ([INF, INF], "0 numbers, 2 inf"),
        ([NAN, NAN], "0 numbers, 2 nan"),
    ],
)
def test_an_array_is_told_in_words(ranges, words):
    assert strict(line(scan(ranges)))["ranges"] == words


def test_an_empty_array_is_told_too():
    assert strict(line(scan([1.0, 2.0])))["intensities"] == "0 numbers"


def test_bytes_are_told_by_their_number():
    assert strict(line(MESSAGES[0]))["data"] == "12 bytes"


def test_in_full_bytes_are_hexadecimal():
    assert strict(line(MESSAGES[0], full=True))["data"] == "0000f401e803dc05d007ffff"


def test_in_full_an_array_is_whole_and_what_is_not_seen_is_null():
    assert strict(line(scan([1.5, NAN, 0.25]), full=True))["ranges"] == [1.5, None, 0.25]


def test_in_full_a_free_beam_is_json_too():
    ranges = strict(line(scan([1.5, INF, NAN]), full=True))["ranges"]
    assert len(ranges) == 3
    assert ranges[0] == 1.5
    assert ranges[1] != ranges[2]


@given(st.text(max_size=30))
def test_any_name_is_shown_as_it_is(frame):
    message = LaserScan.decode(build.payload(build.scan_fields(frame=frame)))
    assert strict(line(message))["frame"] == frame
    assert len(line(message).splitlines()) <= 1 or any(mark in frame for mark in "\x85\u2028\u2029")
