"""Frames are found in any stream, however it is cut."""

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from cliffscan.simulator.kobuki.frames import LONGEST_COMMAND, FrameFinder, frame

GOOD = st.binary(min_size=3, max_size=LONGEST_COMMAND).map(frame)
HARMLESS = st.binary(max_size=40).map(lambda data: data.replace(b"\xaa", b"\xab"))


def feed_in_pieces(finder, stream, cuts):
    found = []
    for start, end in zip([0, *cuts], [*cuts, len(stream)], strict=True):
        found += finder.feed(stream[start:end])
    return found


@pytest.mark.parametrize(
    ("payload", "expected"),
    [
        ("010400000000", "aa550601040000000003"),
        ("010464000000", "aa550601046400000067"),
        ("09020b00", "aa550409020b0004"),
        ("0e0100", "aa55030e01000c"),
    ],
)
def test_a_frame_has_header_length_and_checksum(payload, expected):
    assert frame(bytes.fromhex(payload)).hex() == expected


@pytest.mark.parametrize("size", [0, 256])
def test_a_payload_that_no_length_byte_can_tell_is_refused(size):
    with pytest.raises(ValueError, match=f"payload of {size} bytes, expected 1 to 255"):
        frame(bytes(size))


@given(st.lists(st.tuples(HARMLESS, GOOD), max_size=6), st.data())
def test_good_frames_come_out_of_garbage_however_the_stream_is_cut(pairs, data):
    stream = b"".join(noise + good for noise, good in pairs)
    cuts = sorted(data.draw(st.lists(st.integers(0, len(stream)), max_size=8)))
    finder = FrameFinder()
    assert feed_in_pieces(finder, stream, cuts) == [good[3:-1] for _, good in pairs]
    assert finder.discarded == sum(len(noise) for noise, _ in pairs)


@given(st.lists(st.one_of(st.binary(max_size=30), GOOD, st.just(b"\xaa\x55")), max_size=8), st.data())
@example([b"\xaa\x55\xaa", frame(b"\x01\x01\x01")], None)
def test_cutting_changes_nothing_whatever_the_garbage(mix, data):
    stream = b"".join(mix)
    cuts = sorted(data.draw(st.lists(st.integers(0, len(stream)), max_size=8))) if data else range(1, len(stream))
    assert feed_in_pieces(FrameFinder(), stream, cuts) == FrameFinder().feed(stream)


@pytest.mark.parametrize(
    "before",
    [
        "aa",
        "aa55",
        "aaaa55aa55",
        "aa550601040000000002",  # one bit of the checksum is wrong
        "aa5500",  # a length of nothing
        "aa55ff",  # a length that no command has
        "aa5510",  # a length that reaches over the next frame
    ],
)
def test_a_false_start_costs_no_good_frame(before):
    stop = bytes.fromhex("aa550601040000000003")
    finder = FrameFinder()
    found = finder.feed(bytes.fromhex(before) + 8 * stop)
    assert found == 8 * [stop[3:-1]]
    assert finder.discarded == len(before) // 2
