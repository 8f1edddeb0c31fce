"""A beam's floor begins before the robot and ends at the second ray off it."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays

from cliffscan.services.capture.floor.plane_support import before_second, bits, flags, misses, run, support

RINGS = 64
FLAGS = arrays.arrays(np.bool_, (3, RINGS))


def naive_run(miss, noise_scale, short):
    """The rings of one beam that are floor, looked at one after another."""
    strays = [ring for ring, off in enumerate(miss) if off > 3.0 * noise_scale]
    end = strays[1] - short if len(strays) > 1 else RINGS - short
    return [ring < end and off <= 3.0 * noise_scale for ring, off in enumerate(miss)]


@given(FLAGS)
def test_flags_become_bits_and_flags_again(given_flags):
    np.testing.assert_array_equal(flags(bits(given_flags)), given_flags)


@given(FLAGS)
def test_the_second_stray_ends_the_floor(strays):
    for beam, allowed in zip(strays, flags(before_second(bits(strays))), strict=True):
        places = np.flatnonzero(beam)
        end = places[1] if len(places) > 1 else RINGS
        np.testing.assert_array_equal(allowed, np.arange(RINGS) < end)


@given(
    arrays.arrays(np.float32, (2, RINGS), elements=st.sampled_from([0.0, 0.9, 1.9, 2.9, 3.1, 5.9, 7.0, np.nan])),
    st.sampled_from([1.0, 2.0]),
    st.sampled_from([0, 3]),
)
def test_a_run_is_what_a_slow_look_at_each_beam_makes_it(miss, noise_scale, short):
    assert run(miss, noise_scale, short).tolist() == [naive_run(beam, noise_scale, short) for beam in miss]


def test_a_plane_through_the_rays_misses_none_and_has_most_support():
    slopes = np.random.default_rng(0).normal(size=(3, 2, RINGS)).astype(np.float32)
    planes = np.array([[0.1, -0.2, 1.0], [0.0, 0.0, 1.0]])
    seen = np.einsum("i,ijk->jk", planes[0], slopes).astype(np.float32)
    seen[1, 5:] = np.nan
    miss = misses(seen, slopes, planes) * 100
    assert np.nanmax(miss[0]) < 1e-3
    np.testing.assert_array_equal(np.isnan(miss[1]), np.isnan(seen))
    support_of = support(miss, 1.0)
    assert support_of[0] == 2 * (RINGS + 5)  # each ray once as close, once as likely
    assert support_of[1] < 20
