"""A session is opened anew where nothing passes, and not for ever."""

import pytest

from cliffscan.joined import PATIENCE, TRIES, Joined


@pytest.fixture
def joined():
    made = Joined("router-workstation")
    made.begin()
    made.changed("router-workstation", True)
    return made


def looks(joined, many=PATIENCE, linked=True):
    return [joined.is_shut(linked) for _ in range(many)]


def test_a_router_that_shows_itself_lets_things_pass(joined):
    joined.changed("router-robot", True)
    assert not any(looks(joined, 10))


def test_one_that_is_not_reached_is_waited_for(joined):
    assert not any(looks(joined, 10, linked=False))


def test_one_that_is_reached_and_does_not_show_itself_is_joined_anew(joined):
    joined.changed("fuse", True)
    assert looks(joined) == [False] * (PATIENCE - 1) + [True]
    joined.begin()
    joined.changed("router-robot", True)
    assert not any(looks(joined, 10))


def test_after_some_tries_it_is_left_as_it_is(joined):
    assert sum(looks(joined, 20 * PATIENCE)) == TRIES
    joined.changed("router-robot", True)
    looks(joined)
    joined.changed("router-robot", False)
    assert sum(looks(joined, 20 * PATIENCE)) == TRIES


def test_after_an_outage_it_is_looked_for_again(joined):
    joined.changed("router-robot", True)
    looks(joined)
    joined.changed("router-robot", False)
    assert not any(looks(joined, 10, linked=False))
    assert looks(joined)[-1]
