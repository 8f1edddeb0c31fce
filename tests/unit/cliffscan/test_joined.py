"""A session is opened anew where nothing passes, and not for ever."""

import pytest

from cliffscan.joined import PATIENCE, TRIES, Joined

OWN = {"turtlebot/alive/router-workstation"}
OTHER = OWN | {"turtlebot/alive/router-robot"}
OF_A_CELL = OWN | {"cell3/alive/router-workstation"}


@pytest.fixture
def joined():
    return Joined(*OWN)


def looks(joined, routers=OWN, many=PATIENCE, linked=True):
    return [joined.is_shut(linked, routers) for _ in range(many)]


@pytest.mark.parametrize("routers", [OTHER, OF_A_CELL])
def test_a_router_that_answers_lets_things_pass(joined, routers):
    assert not any(looks(joined, routers, 10))


def test_one_that_is_not_reached_is_waited_for(joined):
    assert not any(looks(joined, many=10, linked=False))


def test_one_that_is_reached_and_does_not_answer_is_joined_anew(joined):
    assert looks(joined) == [False] * (PATIENCE - 1) + [True]
    assert not any(looks(joined, OTHER, 10))


def test_after_some_tries_it_is_left_as_it_is(joined):
    assert sum(looks(joined, many=3 * TRIES * PATIENCE)) == TRIES
    looks(joined, OTHER)
    assert sum(looks(joined, many=3 * TRIES * PATIENCE)) == TRIES


def test_after_an_outage_it_has_its_time_again(joined):
    looks(joined, OTHER)
    looks(joined, many=PATIENCE - 1)
    assert not any(looks(joined, many=10, linked=False))
    assert looks(joined) == [False] * (PATIENCE - 1) + [True]
