"""Faces are closed, face outwards and enclose the volume of what they stand for."""

from collections import Counter
from itertools import pairwise

import mujoco
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from cliffscan.simulator.faces import ROUNDNESS, box_faces, circle, cylinder_faces, faces_of, pack
from cliffscan.simulator.world import World

sizes = st.floats(0.005, 5.0)


def volume(faces):
    """By the divergence theorem; negative where the faces look inwards."""
    total = 0.0
    for face in faces:
        for second, third in pairwise(face[1:]):
            total += np.dot(face[0], np.cross(second, third)) / 6.0
    return total


def directed_edges(faces):
    return Counter(
        (tuple(before), tuple(here))
        for face in faces
        for before, here in zip(np.roll(face, 1, axis=0), face, strict=True)
    )


@given(sizes, sizes, sizes)
def test_a_box_has_its_volume(x, y, z):
    assert volume(box_faces(np.array([x, y, z]))) == pytest.approx(8 * x * y * z)


@settings(max_examples=25)
@given(sizes, sizes)
def test_a_cylinder_has_its_volume(radius, half):
    assert volume(cylinder_faces(np.array([radius, half, 0.0]))) == pytest.approx(2 * half * np.pi * radius**2)


@pytest.mark.parametrize("faces", [box_faces(np.array([1.0, 2.0, 3.0])), cylinder_faces(np.array([0.1, 0.5, 0.0]))])
def test_a_shape_is_closed(faces):
    edges = directed_edges(faces)
    assert set(edges.values()) == {1}
    assert all((there, here) in edges for here, there in edges)


@given(sizes)
def test_a_circle_is_round(radius):
    ring = circle(radius)
    middles = (ring + np.roll(ring, 1, axis=0)) / 2
    assert np.hypot(*ring.T).max() - radius <= 1.01 * ROUNDNESS
    assert radius - np.hypot(*middles.T).min() <= 1.01 * ROUNDNESS


def test_faces_stand_where_their_geom_stands():
    world = World("empty_room")
    faces = faces_of(world)
    assert len(faces.starts) - 1 == 5 * 6
    floor, front = faces.corners[:24], faces.corners[24:48]
    np.testing.assert_allclose(
        [floor.min(axis=0), floor.max(axis=0)], [[-2.1, -2.6, -0.15], [4.1, 2.6, 0.0]], atol=1e-12
    )
    assert front[:, 0].min() == pytest.approx(4.0)


def test_a_geom_that_cannot_be_drawn_is_refused():
    world = World("open_floor")
    world.model.geom_type[0] = mujoco.mjtGeom.mjGEOM_SPHERE
    with pytest.raises(ValueError, match=r"open_floor.*SPHERE.*boxes and cylinders"):
        faces_of(world)


def test_no_faces_are_packed_as_none():
    faces = pack([])
    assert faces.corners.shape == (0, 3)
    assert faces.starts.tolist() == [0]
