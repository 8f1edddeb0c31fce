"""A queue of one, or of a few: the newest wins."""

import threading

from hypothesis import given
from hypothesis import strategies as st

from cliffscan.common.runtime.latest_queue import LatestQueue


def test_an_empty_inbox_gives_nothing():
    assert LatestQueue().get(0.0) is None


def test_what_was_put_is_got_once():
    queue = LatestQueue()
    assert queue.put("a")
    assert queue.get(0.0) == "a"
    assert queue.get(0.0) is None


def test_the_newest_overtakes():
    queue = LatestQueue()
    assert queue.put("old")
    assert not queue.put("new")
    assert queue.get(0.0) == "new"
    assert queue.put("next")


@given(st.integers(1, 5), st.lists(st.integers(), max_size=12))
def test_the_newest_are_held_in_the_order_they_came(room, items):
    queue = LatestQueue(room)
    assert [queue.put(item) for item in items] == [place < room for place in range(len(items))]
    held = [queue.get(0.0) for _ in items[-room:]]
    assert held == items[-room:]
    assert queue.get(0.0) is None


def test_an_item_that_is_false_is_an_item():
    queue = LatestQueue()
    queue.put(0)
    assert queue.get(0.0) == 0


def test_a_reader_that_waits_is_woken():
    queue, got = LatestQueue(), []
    reader = threading.Thread(target=lambda: got.append(queue.get(30.0)))
    reader.start()
    queue.put("a")
    reader.join(60.0)
    assert got == ["a"]
