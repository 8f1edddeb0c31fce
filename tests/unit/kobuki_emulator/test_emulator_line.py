"""What can happen to the stream on its way."""

from hypothesis import given
from hypothesis import strategies as st

from cliffscan.simulator.kobuki.base import Base
from cliffscan.simulator.kobuki.firmware import Firmware
from cliffscan.simulator.kobuki.line import Line
from tests.unit.kobuki_emulator.packets import drive, packets

PACKET = bytes(range(77))
TICK = 0.02


def test_without_faults_everything_arrives_as_it_was_said():
    line = Line()
    assert line.carry(PACKET, TICK) == [PACKET]
    assert line.carry(b"", TICK) == []


@given(st.integers(1, 200), st.integers(1, 20))
def test_cut_pieces_have_one_size_and_lose_nothing(size, count):
    line = Line()
    line.cut(size)
    pieces = [piece for _ in range(count) for piece in line.carry(PACKET, TICK)]
    assert {len(piece) for piece in pieces} <= {size}
    line.cut(0)
    assert b"".join([*pieces, *line.carry(b"", TICK)]) == count * PACKET


def test_garbage_comes_once_ahead_of_the_rest():
    line = Line(seed=1)
    line.garbage(100)
    (piece,) = line.carry(PACKET, TICK)
    assert (len(piece), piece[100:]) == (177, PACKET)
    assert line.carry(PACKET, TICK) == [PACKET]


def test_the_same_seed_makes_the_same_garbage():
    def garbage(seed):
        line = Line(seed)
        line.garbage(50)
        return line.carry(b"", TICK)

    assert garbage(1) == garbage(1) != garbage(2)


def test_corrupt_packets_have_one_bit_flipped():
    line = Line()
    line.corrupt(2)
    said = [line.carry(PACKET, TICK)[0] for _ in range(3)]
    flipped = [sum((one ^ other).bit_count() for one, other in zip(PACKET, got, strict=True)) for got in said]
    assert flipped == [1, 1, 0]


def test_a_pause_loses_what_is_said_in_it():
    line = Line()
    line.pause(0.05)
    assert [len(line.carry(PACKET, TICK)) for _ in range(4)] == [0, 0, 0, 1]


def test_a_base_without_its_cable_goes_on_and_hears_nothing():
    base = Base(Firmware(dead_time=0.0))
    base.receive(drive(200))
    base.step(1.0)
    base.unplug(1.0)
    assert not base.plugged
    assert base.receive(drive(0)) == []
    assert [base.step(0.25) for _ in range(4)] == [[], [], [], []]
    assert base.plugged
    assert base.firmware.drive.speeds.left > 0.19
    told = packets(b"".join(base.step(0.02)))
    assert told[0]["core"]["stamp"] == 2020


def test_an_owner_can_sleep_until_the_next_event():
    base = Base()
    assert base.until_next() == 0.02
    base.step(0.015)
    assert base.until_next() == 0.005
    base.unplug(0.001)
    assert base.until_next() == 0.001
    base.step(0.001)
    base.firmware.power_cycle(2.0)
    assert base.until_next() == 2.0
