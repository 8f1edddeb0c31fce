"""Processes share robots evenly, all of them find the same, and whoever comes or goes moves as few as can be."""

from collections import Counter

import pytest
from hypothesis import given
from hypothesis import strategies as st

from cliffscan.services.perception.shares import balanced, heaviest

ROBOTS = [f"cell{number % 3}/r{number}" for number in range(14)]
names = st.text("abc/", min_size=1, max_size=4)
members = st.sets(st.sampled_from("mnopq"), min_size=1)


def loads(shares, members):
    return sorted(Counter(dict.fromkeys(members, 0) | Counter(shares.values())).values())


@given(st.sets(names), members, st.dictionaries(names, st.sampled_from("mnopq")))
def test_every_robot_has_one_member_and_no_member_has_two_more_than_another(robots, members, holders):
    shares = balanced(robots, members, holders)
    assert robots <= shares.keys()
    assert set(shares.values()) <= members
    least, *_, most = [*loads(shares, members), max(loads(shares, members))]
    assert most - least <= 1


@given(st.lists(names, unique=True), st.lists(st.sampled_from("mnopq"), unique=True, min_size=1), st.randoms())
def test_the_order_in_which_others_became_known_does_not_matter(robots, members, random):
    expected = balanced(robots, members, {})
    random.shuffle(robots)
    random.shuffle(members)
    assert balanced(robots, members, {}) == expected


def test_who_has_a_robot_keeps_it_when_others_come():
    holders = {"a": "m", "b": "n"}
    assert balanced("abc", "mn", holders).items() >= holders.items()
    assert balanced("ab", "mno", holders) == holders


@pytest.mark.parametrize(("before", "after", "moved"), [("m", "mn", 7), ("mn", "mno", 4), ("mno", "mn", 5)])
def test_only_as_many_robots_move_as_must(before, after, moved):
    first = balanced(ROBOTS, before, {})
    second = balanced(ROBOTS, after, first)
    assert sum(first[robot] != second[robot] for robot in ROBOTS) <= moved
    assert max(loads(second, after)) - min(loads(second, after)) <= 1


def test_a_robot_leans_to_one_process_whoever_else_is_there():
    first = heaviest("cell3/r17", "mnopq")
    assert all(heaviest("cell3/r17", {first, other}) == first for other in "mnopq")
    assert {heaviest(robot, "mn") for robot in ROBOTS} == {"m", "n"}
