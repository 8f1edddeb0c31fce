"""Points and places as a pose sees them."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from cliffscan.safety.pose2d import Pose2D

poses = st.builds(Pose2D, st.floats(-50, 50), st.floats(-50, 50), st.floats(-10, 10))


@given(poses, poses, st.floats(-5, 5), st.floats(-5, 5))
def test_there_and_back_again(one, other, x, y):
    point = np.array([[x], [y]])
    assert one.from_world(one.to_world(point)) == pytest.approx(point, abs=1e-9)
    assert one.then(other).to_world(point) == pytest.approx(one.to_world(other.to_world(point)), abs=1e-9)
