"""A stream whose stamps or numbers go back is told of, once each time."""

from hypothesis import given
from hypothesis import strategies as st

from cliffscan.common.runtime.stream_order import StreamOrder


def verdicts(*samples):
    order = StreamOrder()
    odd = [order.check(seq, stamp) for seq, stamp in samples]
    return [each and each.what for each in odd]


def test_a_steady_stream_is_in_order():
    assert verdicts((0, 10), (1, 20), (2, 30)) == [None] * 3


def test_frames_may_be_lost_and_stamps_may_repeat():
    assert verdicts((3, 10), (9, 10), (9, 10), (700, 2**62)) == [None] * 4


def test_a_stamp_that_goes_back_is_told_of():
    order = StreamOrder()
    order.check(1, 1000)
    oddity = order.check(2, 400)
    assert oddity.what == "stamp_back"
    assert "stamp 400 comes 600 ns before the last one" in oddity.why


def test_a_clock_set_back_is_told_of_once():
    assert verdicts((1, 1000), (2, 400), (3, 410), (4, 420)) == [None, "stamp_back", None, None]


def test_of_an_absurd_stamp_its_successor_tells():
    assert verdicts(*enumerate([10, 20, 2**62, 40, 50])) == [None, None, None, "stamp_back", None]


def test_a_restarted_camera_is_told_of():
    order = StreamOrder()
    order.check(900, 1000)
    oddity = order.check(0, 2000)
    assert oddity.what == "sequence_back"
    assert "0 after 900" in oddity.why
    assert order.check(1, 2001) is None


def test_two_cameras_on_one_key_are_told_of():
    samples = [(100 * (n % 2) + n // 2, 10 * n) for n in range(8)]
    assert verdicts(*samples) == [None, None] + ["sequence_back", None] * 3


@given(st.lists(st.tuples(st.integers(0, 2**64 - 1), st.integers(0, 2**63 - 1))))
def test_a_stamp_is_told_of_exactly_if_it_is_older_than_its_predecessor(samples):
    order = StreamOrder()
    before = 0
    for seq, stamp in samples:
        oddity = order.check(seq, stamp)
        assert (oddity is not None and oddity.what == "stamp_back") == (stamp < before)
        before = stamp
