"""All that handles scans follows the table of a beam's fields."""

import math
from pathlib import Path

import numpy as np
import pytest

from cliffscan.common.contract import limits
from cliffscan.common.contract.beam_fields import BEAM_FIELDS, Beams, Combining
from cliffscan.common.contract.message import MessageError
from cliffscan.common.contract.messages import LaserScan
from cliffscan.common.perception.combine import combine, within
from cliffscan.services.fuse.fusion import fuse
from cliffscan.services.fuse.pairing import Pair
from tests import build

PAGE = (Path(__file__).parents[3] / "common" / "README.md").read_text()
OPTIONAL = [name for name, row in BEAM_FIELDS.items() if row.optional]
FINITE = [name for name, row in BEAM_FIELDS.items() if row.finite]
BOUNDED = [name for name, row in BEAM_FIELDS.items() if math.isfinite(row.least)]


def valid(row):
    """What the table on the wire page says is valid."""
    least = f"{row.least:g} or more" if math.isfinite(row.least) else ""
    words = [["finite", least], [least or "any", "+inf", "NaN"]][not row.finite]
    return ", ".join(filter(None, words)) + ("; or absent" if row.optional else "")


def beams(**fields):
    """Two beams whose fields hold 1 and 2 unless told otherwise."""
    return Beams(**{name: np.float32([1.0, 2.0]) for name in BEAM_FIELDS} | fields)


def message(**fields):
    """A scan of two beams, as a foreign client packs it."""
    arrays = {name: values.tobytes() for name, values in beams(**fields).arrays().items()}
    return build.payload(build.scan_fields(angle_increment=1.0, range_max=10.0, **arrays))


@pytest.mark.parametrize("name", BEAM_FIELDS)
def test_the_wire_page_has_the_row(name):
    row = BEAM_FIELDS[name]
    assert f"| `{name}` | {row.unit} | {row.meaning} | {valid(row)} | {row.combining.value} |\n" in PAGE


def test_a_scan_has_the_fields_after_those_of_all_beams():
    assert list(LaserScan.model_fields)[-len(BEAM_FIELDS) :] == list(BEAM_FIELDS)
    LaserScan.decode(message())


def test_a_scan_of_as_many_beams_as_there_can_be_is_no_larger_than_a_payload():
    assert len(BEAM_FIELDS) * 4 * limits.MOST_BEAMS + limits.SMALL <= limits.PAYLOAD["LaserScan"]


@pytest.mark.parametrize("name", OPTIONAL)
def test_an_optional_field_may_be_absent(name):
    assert len(getattr(LaserScan.decode(message(**{name: np.empty(0, np.float32)})), name)) == 0


@pytest.mark.parametrize("count", [0, 1, 3])
@pytest.mark.parametrize("name", BEAM_FIELDS)
def test_a_field_has_as_many_values_as_there_are_beams(name, count):
    if name in OPTIONAL and count == 0:
        return
    with pytest.raises(MessageError, match=r"beams"):
        LaserScan.decode(message(**{name: np.ones(count, np.float32)}))


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
@pytest.mark.parametrize("name", FINITE)
def test_a_finite_field_is_finite(name, value):
    with pytest.raises(MessageError, match=f"{name}: not finite"):
        LaserScan.decode(message(**{name: np.float32([1.0, value])}))


@pytest.mark.parametrize("name", BOUNDED)
def test_a_bounded_field_keeps_its_bound(name):
    below = np.nextafter(np.float32(BEAM_FIELDS[name].least), np.float32(-1.0))
    with pytest.raises(MessageError, match=name):
        LaserScan.decode(message(**{name: np.float32([1.0, below])}))


@pytest.mark.parametrize("name", BEAM_FIELDS)
def test_fields_combine_and_fuse_as_their_rows_say(name):
    """One scan is nearer in the first beam, the other in the second; its own value is the greater one."""
    near, far = np.float32([1.0, 2.0]), np.float32([2.0, 1.0])
    one, other = beams(ranges=near, **own(name, [5, 3])), beams(ranges=far, **own(name, [4, 6]))
    expected = {Combining.NEAREST: [1, 1], Combining.OF_NEAREST: [5, 6], Combining.LEAST: [4, 3]}
    combined = combine([one, other])
    assert getattr(combined, name).tolist() == expected[BEAM_FIELDS[name].combining]
    scans = [LaserScan.decode(message(**each.arrays())) for each in (one, other)]
    assert getattr(fuse(Pair(*scans), {}), name).tolist() == getattr(combined, name).tolist()


@pytest.mark.parametrize("name", BEAM_FIELDS)
def test_nothing_is_said_beyond_range_max(name):
    limited = within(beams(ranges=np.float32([1.0, 9.0]), **own(name, [1, 9])), 3.0)
    expected = {Combining.NEAREST: [1, math.inf], Combining.OF_NEAREST: [1, 0], Combining.LEAST: [1, 3]}
    assert getattr(limited, name).tolist() == expected[BEAM_FIELDS[name].combining]


@pytest.mark.parametrize("name", OPTIONAL)
def test_a_field_that_no_scan_has_stays_absent(name):
    without = beams(**{name: np.empty(0, np.float32)})
    assert len(getattr(within(combine([without, without]), 3.0), name)) == 0


def own(name, values):
    """A field's values, but for the ranges, which say what is nearest."""
    return {} if BEAM_FIELDS[name].combining is Combining.NEAREST else {name: np.float32(values)}
