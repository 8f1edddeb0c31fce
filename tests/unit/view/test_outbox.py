"""Credits: two on the way, the newest of each kind wins, none is starved."""

import threading
import time

import pytest

from cliffscan.view.outbox import OUTSTANDING, Outbox

DEADLINE = 60.0  # [s]


@pytest.fixture
def outbox():
    made = Outbox({})
    yield made
    made.close()


def offer(outbox, kind, text):
    outbox.offer(kind, lambda: text)


def taken(outbox):
    """What the next message says, and its number; asked by a thread, for it may have to wait."""
    found = []
    thread = threading.Thread(target=lambda: found.append(outbox.take()), daemon=True)
    thread.start()
    thread.join(DEADLINE)
    return found[0].number, found[0].make()


def test_no_more_go_than_are_acknowledged(outbox):
    numbers = []
    for text in "abc":
        offer(outbox, "scene", text)
        if len(numbers) < OUTSTANDING:
            numbers.append(taken(outbox)[0])
    waiting = []
    thread = threading.Thread(target=lambda: waiting.append(outbox.take()), daemon=True)
    thread.start()
    offer(outbox, "scene", "d")
    assert outbox.acknowledge(12345) is None  # gives no credit
    assert not waiting
    kind, late = outbox.acknowledge(numbers[1])
    assert kind == "scene"
    assert 0.0 <= late < DEADLINE
    thread.join(DEADLINE)
    assert waiting[0].make() == "d"  # c was overtaken


def test_what_is_overtaken_is_never_made(outbox):
    made = []
    for text in "ab":
        outbox.offer("scene", lambda text=text: made.append(text) or text)
    assert taken(outbox)[1] == "b"
    assert made == ["b"]


def test_every_kind_has_its_turn(outbox):
    for kind in ("scene", "depth", "state"):
        offer(outbox, kind, kind)
    seen = set()
    for _ in range(3):
        number, text = taken(outbox)
        offer(outbox, "scene", "scene")  # comes more often than the others
        outbox.acknowledge(number)
        seen.add(text)
    assert seen == {"scene", "depth", "state"}


def test_a_period_is_kept_by_all_of_a_kind_s_first_word():
    outbox = Outbox({"map": 0.05})
    offer(outbox, "map one", "a")
    number, _ = taken(outbox)
    outbox.acknowledge(number)
    begun = time.monotonic()
    offer(outbox, "map one", "b")
    offer(outbox, "scene", "c")
    first, second = taken(outbox), taken(outbox)
    assert (first[1], second[1]) == ("c", "b")
    assert time.monotonic() - begun > 0.02
    outbox.close()


def test_closing_ends_the_one_that_waits(outbox):
    ended = []
    thread = threading.Thread(target=lambda: ended.append(outbox.take()), daemon=True)
    thread.start()
    outbox.close()
    thread.join(DEADLINE)
    assert ended == [None]


def test_without_credits_all_go():
    outbox = Outbox({}, outstanding=None)
    for number in range(1, 6):
        offer(outbox, "x", number)
        assert taken(outbox) == (number, number)
    outbox.close()
