"""A queue of one, or of a few: the newest wins."""

import threading

from hypothesis import given
from hypothesis import strategies as st

from cliffscan.common.runtime.latest_queue import Inbox


def test_an_empty_inbox_gives_nothing():
    assert Inbox().get(0.0) is None


def test_what_was_put_is_got_once():
    inbox = Inbox()
    assert inbox.put("a")
    assert inbox.get(0.0) == "a"
    assert inbox.get(0.0) is None


def test_the_newest_overtakes():
    inbox = Inbox()
    assert inbox.put("old")
    assert not inbox.put("new")
    assert inbox.get(0.0) == "new"
    assert inbox.put("next")


@given(st.integers(1, 5), st.lists(st.integers(), max_size=12))
def test_the_newest_are_held_in_the_order_they_came(room, items):
    inbox = Inbox(room)
    assert [inbox.put(item) for item in items] == [place < room for place in range(len(items))]
    held = [inbox.get(0.0) for _ in items[-room:]]
    assert held == items[-room:]
    assert inbox.get(0.0) is None


def test_an_item_that_is_false_is_an_item():
    inbox = Inbox()
    inbox.put(0)
    assert inbox.get(0.0) == 0


def test_a_reader_that_waits_is_woken():
    inbox, got = Inbox(), []
    reader = threading.Thread(target=lambda: got.append(inbox.get(30.0)))
    reader.start()
    inbox.put("a")
    reader.join(30.0)
    assert got == ["a"]
