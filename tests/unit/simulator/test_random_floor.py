"""Random floors are sensible, whatever the seed, and have everything there is, over all seeds."""

from itertools import combinations

import mujoco
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from cliffscan.simulator.random_floor import PASSAGE, START, FloorPlan, random_floor, slice_of, without
from cliffscan.simulator.robot import RobotSimulation
from cliffscan.simulator.scene import Rectangle
from cliffscan.simulator.truth import BODY, floor_edge, obstacle
from cliffscan.simulator.world import World

SEEDS = range(40)
AROUND = np.radians(np.arange(0.0, 360.0, 5.0))
CUTS = st.lists(st.tuples(st.integers(0, 9), st.integers(0, 9), st.integers(1, 3), st.integers(1, 3)), max_size=6)


def names(seed):
    model = mujoco.MjModel.from_xml_string(random_floor(seed))
    return [model.geom(geom).name for geom in range(model.ngeom)]


def test_a_seed_is_a_floor():
    assert random_floor(5) == random_floor(5)
    assert random_floor(5) != random_floor(6)


def test_every_kind_of_thing_is_there_in_some_of_the_floors():
    seen = [set(names(seed)) for seed in SEEDS]
    kinds = ("hole_0_ground", "kerb_1", "kerb_1_lower", "stairs_1_tread_0", "ramps_1_up", "table_1", "box_1")
    assert all(any(kind in floor for floor in seen) for kind in (*kinds, "partition_0_near", "partition_1_far"))


@pytest.mark.parametrize("seed", SEEDS)
def test_the_start_is_free(seed):
    world = World(f"random:{seed}")
    edges, obstacles = floor_edge(world, AROUND), obstacle(world, AROUND, *BODY)
    assert np.minimum(edges, obstacles).min() > min(START.right, -START.left, START.far, -START.near)
    assert np.isfinite(np.minimum(edges, obstacles)).all()  # walls all around


@pytest.mark.parametrize("seed", [0, 2, 8])
def test_a_robot_stands_still_at_the_start(seed):
    simulation = RobotSimulation(f"random:{seed}")
    simulation.step(1.0)
    assert simulation.pose == pytest.approx((0.0, 0.0, 0.0), abs=1e-4)
    assert simulation.bumped is simulation.fallen is False


@given(cuts=CUTS)
def test_floor_and_cuts_are_the_whole(cuts):
    chosen = []
    for left, near, width, depth in cuts:
        cut = Rectangle(left, left + width, near, near + depth)
        if not any(cut.meets(other) for other in chosen):
            chosen.append(cut)
    parts = without(Rectangle(-1.0, 13.0, -1.0, 13.0), chosen)
    covered = np.zeros((14, 14), dtype=int)
    for part in [*parts, *chosen]:
        covered[int(part.left) + 1 : int(part.right) + 1, int(part.near) + 1 : int(part.far) + 1] += 1
    assert (covered == 1).all()


@pytest.mark.parametrize("along_x", [True, False])
@pytest.mark.parametrize("backward", [True, False])
def test_slices_are_equal_and_in_order(along_x, backward):
    area = Rectangle(0.0, 3.0, 0.0, 3.0)
    slices = [slice_of(area, step, 3, along_x, backward) for step in range(3)]
    assert not any(one.meets(other) for one, other in combinations(slices, 2))
    starts = [part.left if along_x else part.near for part in slices]
    assert starts == ([2.0, 1.0, 0.0] if backward else [0.0, 1.0, 2.0])


def test_a_floor_for_a_larger_robot_is_larger_too():
    for_turtlebots, for_larger_ones = FloorPlan(5, PASSAGE), FloorPlan(5, 2 * PASSAGE)
    assert for_larger_ones.outer == tuple(2 * side for side in for_turtlebots.outer)
    assert World("random:5:0.6").model.ngeom == World("random:5").model.ngeom
