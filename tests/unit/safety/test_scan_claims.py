"""A scan frees no more than the camera can see, and one that is no scan of a camera is refused."""

import math

import numpy as np
import pytest

from cliffscan.common.contract.description import CameraDescription
from cliffscan.safety import scan_claims
from cliffscan.safety.scan_claims import AHEAD, Scan, View
from tests import build

NOW = 1_700_000_000_000_000_000  # [ns]
CAMERA = CameraDescription(frame="camera", simulated=False, nearest_floor=1.4, farthest=3.0, field_of_view=(-0.3, 0.4))


def sent(ranges, increment=0.02, stamp=NOW, **changes):
    return build.scan(ranges, **changes).model_copy(
        update={
            "stamp": stamp,
            "angle_min": -increment * (len(ranges) - 1) / 2,
            "angle_max": increment * (len(ranges) - 1) / 2,
            "angle_increment": increment,
        }
    )


def test_a_scan_of_the_present_on_a_fine_grid_is_taken():
    assert not scan_claims.refusal(sent([1.0] * 40), NOW)
    assert not scan_claims.refusal(sent([1.0] * 40), NOW + 10**9)
    assert not scan_claims.refusal(sent([1.0] * 40, stamp=NOW + round(AHEAD * 1e9)), NOW)


@pytest.mark.parametrize("ahead", [0.05, 0.09, 3600.0])
def test_a_scan_of_the_future_is_refused(ahead):
    assert "ahead of this clock" in scan_claims.refusal(sent([1.0] * 40, stamp=NOW + round(ahead * 1e9)), NOW)


def test_a_scan_of_two_beams_or_of_one_is_refused():
    assert "degrees wide" in scan_claims.refusal(sent([math.inf] * 2, increment=1.0), NOW)
    assert "one beam" in scan_claims.refusal(sent([math.inf], increment=0.1), NOW)


def test_beams_that_lie_nowhere_are_refused():
    far = sent([math.inf] * 40).model_copy(update={"angle_min": 1e300, "angle_max": 1e300})
    assert "beams lie at" in scan_claims.refusal(far, NOW)


def test_nothing_is_free_outside_of_the_described_view():
    scan = Scan.of(sent([math.inf] * 101, increment=0.01), View.of(CAMERA))
    inside = (scan.angles >= -0.3 - math.radians(1)) & (scan.angles <= 0.4 + math.radians(1))
    assert (scan.free[~inside] == 0.0).all()
    np.testing.assert_array_equal(scan.free[inside], 3.0)


def test_a_beam_that_saw_nothing_cannot_have_seen_floor_to_its_end():
    nothing = [math.nan] * 40
    claims = sent(nothing, clear=[9.0] * 20 + [1e30] * 20)
    free = Scan.of(claims, View.undescribed()).free
    np.testing.assert_array_equal(free[:20], 9.0)
    np.testing.assert_array_equal(free[20:], 0.0)
