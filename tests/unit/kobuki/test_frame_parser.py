"""However a stream is cut, the same packets come out, and only a chance frame in garbage can hide one."""

import random

import pytest
from hypothesis import assume, example, given
from hypothesis import strategies as st

from cliffscan.services.kobuki.protocol.frames import FrameCounts, FrameParser, frame
from cliffscan.services.kobuki.protocol.packets import decode
from tests.kobuki_stream import HEADER, NaiveParser, framed, usual_payload

LONGEST_FRAME = 259
GOOD = [usual_payload(20 * n, 7 * n, 9 * n, samples=2 + n % 2) for n in range(200)]

payloads = st.one_of(st.sampled_from(GOOD), st.binary(max_size=40), st.binary(min_size=255, max_size=255))
header_like = st.lists(st.sampled_from([0xAA, 0x55, 0, 1, 4, 0xFF]), max_size=60).map(bytes)
garbage = st.one_of(
    st.binary(max_size=300), header_like, st.just(HEADER), st.sampled_from(GOOD).map(lambda p: framed(p)[:50])
)
streams = st.lists(st.one_of(payloads.map(framed), garbage), max_size=8).map(b"".join)
quiet = st.binary(max_size=300).map(lambda noise: noise.replace(b"\x55", b"\x54"))  # no `AA 55`, whatever follows it


def fed(*chunks):
    parser = FrameParser()
    found = [payload for chunk in chunks for payload in parser.feed(chunk)]
    return found, parser


@st.composite
def cut(draw, streams=streams):
    """A stream, and the same in pieces."""
    stream = draw(streams)
    places = sorted(draw(st.lists(st.integers(0, len(stream)), max_size=12)))
    return stream, [stream[a:b] for a, b in zip([0, *places], [*places, len(stream)], strict=True)]


@given(cut())
def test_the_same_comes_out_however_the_stream_is_cut(stream_and_pieces):
    stream, pieces = stream_and_pieces
    whole, parser = fed(stream)
    in_pieces, same = fed(*pieces)
    assert in_pieces == whole
    assert same.counts == parser.counts


@given(streams)
@example(HEADER + HEADER + framed(b"\x01"))
@example(b"\xaa" * 3 + framed(b""))
@example(HEADER + b"\xff" + framed(GOOD[0]) * 4)
def test_it_is_the_slow_parser(stream):
    slow = NaiveParser()
    expected = slow.feed(stream)
    found, parser = fed(stream)
    assert found == expected
    assert parser.counts == FrameCounts(slow.good, slow.bad_checksums, slow.skipped)


@given(streams)
def test_a_packet_comes_out_with_its_last_byte(stream):
    slow, parser = NaiveParser(), FrameParser()
    for place in range(len(stream)):
        byte = stream[place : place + 1]
        assert parser.feed(byte) == slow.feed(byte)


@given(st.lists(st.tuples(quiet, st.lists(payloads, min_size=1, max_size=3)), max_size=6))
def test_every_packet_is_found_behind_another_or_behind_garbage_without_a_header(parts):
    stream = b"".join(noise + b"".join(map(framed, good)) for noise, good in parts)
    found, parser = fed(stream)
    assert found == [payload for _, good in parts for payload in good]
    assert parser.counts == FrameCounts(len(found), 0, sum(len(noise) for noise, _ in parts))


@given(garbage, quiet.filter(bool), payloads)
def test_a_packet_is_found_behind_as_much_quiet_as_the_longest_frame_has(noise, silence, payload):
    assume(HEADER not in noise[-1:] + silence)
    silence = (silence * LONGEST_FRAME)[:LONGEST_FRAME]
    assert fed(noise + silence + framed(payload))[0][-1:] == [payload]


@given(st.one_of(garbage, st.binary(min_size=300, max_size=600)))
def test_any_garbage_costs_only_packets_that_begin_within_258_bytes_of_it(noise):
    good = [framed(payload) for payload in GOOD[:8]]
    assert all(packet.count(HEADER) == 1 for packet in good)  # nothing inside them looks like the beginning of one
    found, _ = fed(noise + b"".join(good))
    begins = [sum(map(len, good[:n])) for n in range(len(good))]
    certain = [payload for payload, begin in zip(GOOD[:8], begins, strict=True) if begin >= LONGEST_FRAME - 1]
    assert len(certain) >= 4
    assert found[-len(certain) :] == certain


def test_a_chance_frame_hides_no_packet_that_is_whole_inside_it():
    for filler in range(256):
        for length in (len(framed(GOOD[0])), 0xAA):  # the first claims to end where the first packet ends
            noise = HEADER + bytes([length, filler])
            assert fed(noise + b"".join(map(framed, GOOD[:4])))[0] == GOOD[:4]


def test_a_chance_frame_can_hide_one_whose_header_it_covers_and_the_next_is_found():
    victim = framed(bytes([99, 1, 0, 98, 148]) + bytes(148))
    found, parser = fed(HEADER + bytes([4]) + victim + framed(GOOD[2]))
    assert found == [victim[:4], GOOD[2]]
    assert parser.counts == FrameCounts(2, 0, len(victim) - 5)
    assert fed(HEADER + bytes([5]) + victim + framed(GOOD[2]))[0] == [victim[3:-1], GOOD[2]]


def test_a_frame_that_is_no_sequence_gives_way_to_a_packet_only():
    loose_end = bytes([99, 0, 98])
    for inner in (framed(b""), framed(loose_end), HEADER + b"\x02\x63\x00\x00", framed(GOOD[0])[:-1]):
        assert fed(framed(inner + loose_end))[0] == [inner + loose_end]
    for packet in (GOOD[0], bytes([99, 0])):
        assert fed(framed(bytes([99, len(packet) + 4]) + framed(packet) + bytes([98])))[0] == [packet]


def test_a_frame_inside_a_well_formed_packet_is_its_data():
    payload = bytes([99, 85]) + framed(GOOD[0]) + bytes(4)
    assert fed(framed(payload))[0] == [payload]


@pytest.mark.parametrize("size", [1, 7, 40, 62, 81, 184, 4096])
def test_fragmented_reads_lose_nothing(size):
    stream = b"".join(map(framed, GOOD))
    found, parser = fed(*(stream[place : place + size] for place in range(0, len(stream), size)))
    assert found == GOOD
    assert parser.counts == FrameCounts(200, 0, 0)


def test_a_bad_checksum_costs_one_packet():
    bad = bytearray(framed(GOOD[1]))
    bad[-1] ^= 0xFF
    found, parser = fed(framed(GOOD[0]) + bytes(bad) + framed(GOOD[2]))
    assert found == [GOOD[0], GOOD[2]]
    assert parser.counts == FrameCounts(2, 1, len(bad))


def test_a_repeated_header_swallows_nothing():
    found, parser = fed(HEADER * 3 + b"".join(map(framed, GOOD[:4])))
    assert found == GOOD[:4]
    assert parser.counts[0::2] == (4, 6)


def test_a_truncated_packet_costs_itself():
    found, _ = fed(framed(GOOD[0])[:50] + framed(GOOD[1]) + framed(GOOD[2]))
    assert found == [GOOD[1], GOOD[2]]


def test_a_frame_whose_checksum_is_half_a_header_begins_no_other():
    payload = b"\xab"  # with its length, 1, this gives the checksum AA
    assert framed(payload)[-1] == 0xAA
    assert fed(framed(payload), b"\x55\x00\x00")[0] == [payload]


def test_memory_is_bounded():
    parser = FrameParser()
    for _ in range(1000):
        parser.feed(b"\xaa")
        parser.feed(HEADER + b"\xff")
        assert len(vars(parser)["_rest"]) < LONGEST_FRAME


@pytest.mark.parametrize("alphabet", [range(256), [0xAA, 0x55], [0xAA, 0x55, 0xFF, 0]], ids=["any", "headers", "long"])
def test_random_bytes_neither_crash_nor_stall(alphabet):
    dice = random.Random(7)
    parser, total = FrameParser(), 10_000_000 if len(alphabet) == 256 else 500_000
    fed_bytes = good_bytes = 0
    while fed_bytes < total:
        size = dice.randrange(1, 65536)
        chunk = dice.randbytes(size) if len(alphabet) == 256 else bytes(dice.choices(alphabet, k=size))
        fed_bytes += size
        for payload in parser.feed(chunk):
            good_bytes += len(payload) + 4
            decode(payload)
    assert fed_bytes - LONGEST_FRAME < good_bytes + parser.counts.skipped <= fed_bytes
    assert parser.counts.bad_checksums > parser.counts.good


@given(st.binary(max_size=255))
def test_a_frame_is_header_length_payload_and_checksum(payload):
    assert frame(payload) == framed(payload)


@pytest.mark.parametrize(
    ("payload", "wire"),
    [("", "aa550000"), ("010400000000", "aa550601040000000003"), ("010464000000", "aa550601046400000067")],
)
def test_frames_of_the_protocol(payload, wire):
    assert frame(bytes.fromhex(payload)).hex() == wire
    assert fed(bytes.fromhex(wire))[0] == [bytes.fromhex(payload)]


def test_the_longest_payload_fits_and_a_longer_one_is_refused():
    assert fed(frame(bytes(255)))[0] == [bytes(255)]
    with pytest.raises(ValueError, match="256 bytes, expected at most 255"):
        frame(bytes(256))
