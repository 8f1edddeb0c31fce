"""Six numbers say what the matrix says."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from cliffscan.services.kobuki.covariance import Covariance

numbers = st.floats(-10.0, 10.0)
covariances = st.builds(Covariance, *[numbers] * 6)


def matrix(covariance):
    return np.reshape(covariance.rows(), (3, 3))


@given(covariances, numbers, numbers)
def test_a_motion_turns_an_error_of_the_heading_into_one_of_the_place(covariance, dx, dy):
    jacobian = np.array([[1, 0, -dy], [0, 1, dx], [0, 0, 1]])
    np.testing.assert_allclose(
        matrix(covariance.moved(dx, dy)), jacobian @ matrix(covariance) @ jacobian.T, rtol=1e-9, atol=1e-9
    )


@given(covariances, covariances)
def test_what_is_independent_adds_up(one, other):
    np.testing.assert_array_equal(matrix(one.plus(other)), matrix(one) + matrix(other))


def test_deviations_are_squared_on_the_diagonal():
    assert Covariance.of_deviations(2.0, 3.0, 4.0).rows() == [4, 0, 0, 0, 9, 0, 0, 0, 16]
