"""What a killed writer left is read up to its last whole chunk, and mended."""

import pytest
from mcap.reader import make_reader
from mcap.records import Chunk
from mcap.stream_reader import StreamReader
from mcap.writer import Writer

from cliffscan.common.runtime.raw_samples import RawSample
from cliffscan.recording.parts import Limits, Parts
from cliffscan.recording.reading import NO_SCHEMA, Recording
from cliffscan.recording.recover import recover

CHUNKS, EACH = 6, 5


def sample(number):
    return RawSample("scan/fused", "application/msgpack", 1000 + number, b"", bytes([number]) * 50)


@pytest.fixture
def whole(tmp_path):
    """A recording of CHUNKS chunks with EACH samples, and where each chunk ends."""
    path, ends = tmp_path / "whole.mcap", []
    with Parts(path, "turtlebot", Limits(), None) as parts:
        for chunk in range(CHUNKS):
            for number in range(EACH):
                parts.add(sample(chunk * EACH + number))
            parts.flush()
            ends.append(path.stat().st_size)
    return path, ends


def numbers(path):
    recording = Recording(path)
    return [each.received - 1000 for each in recording.samples()], recording.damage


def cut(path, length, tmp_path):
    made = tmp_path / "cut.mcap"
    made.write_bytes(path.read_bytes()[:length])
    return made


def change(path, chunk, tmp_path):
    """A file in which something is changed in the data of the chunk at `chunk`."""
    data = bytearray(path.read_bytes())
    data[chunk + 60] ^= 0xFF
    made = tmp_path / "changed.mcap"
    made.write_bytes(data)
    return made


def first_chunk(path):
    """Where the first chunk begins."""
    with path.open("rb") as file:
        records = StreamReader(file, emit_chunks=True).records
        while True:
            begin = file.tell()
            if isinstance(next(records), Chunk):
                return begin


def test_a_whole_file_is_read_whole(whole):
    found, damage = numbers(whole[0])
    assert found == list(range(CHUNKS * EACH))
    assert damage.words == ""


def test_wherever_a_file_is_cut_all_whole_chunks_are_read(whole, tmp_path):
    path, ends = whole
    begin = ends[0] // 2
    for length in range(begin, path.stat().st_size, 7):
        found, damage = numbers(cut(path, length, tmp_path))
        chunks = len(found) // EACH
        assert found == list(range(chunks * EACH))
        assert chunks >= sum(end <= length for end in ends)
        assert damage.words.startswith("its writer did not finish it")


def test_a_chunk_that_changed_is_left_out_alone(whole, tmp_path):
    path, ends = whole
    found, damage = numbers(change(path, ends[1], tmp_path))
    assert found == [each for each in range(CHUNKS * EACH) if not 2 * EACH <= each < 3 * EACH]
    assert damage.words == f"1 chunks hold something else than they should, {EACH} messages cannot be read"


def test_channels_that_were_in_a_chunk_that_changed_are_read_at_the_end(whole, tmp_path, capsys):
    path, _ = whole
    changed, fixed = change(path, first_chunk(path), tmp_path), tmp_path / "fixed.mcap"
    rest = list(range(EACH, CHUNKS * EACH))
    found, damage = numbers(changed)
    assert found == rest
    assert (damage.chunks, damage.messages) == (1, EACH)
    assert recover(changed, fixed) == 0
    assert numbers(fixed)[0] == rest
    assert f"{EACH} messages cannot be read" in capsys.readouterr().err


def test_messages_whose_channel_is_nowhere_are_counted(whole, tmp_path, capsys):
    path, ends = whole
    broken = change(cut(path, ends[2], tmp_path), first_chunk(path), tmp_path)
    assert recover(broken, tmp_path / "fixed.mcap") == 1
    assert f"{3 * EACH} messages cannot be read" in capsys.readouterr().err


def test_a_channel_whose_schema_is_nowhere_costs_its_messages_alone(tmp_path, capsys):
    path = tmp_path / "foreign.mcap"
    with path.open("wb") as file:
        writer = Writer(file)
        writer.start()
        schema = writer.register_schema("first", "ros2msg", b"")
        first = writer.register_channel("/first", "cdr", schema)
        writer.add_message(first, 1, b"1", 1)
        writer.flush()
        for topic, kind in (("/second", schema), ("/third", NO_SCHEMA)):
            writer.add_message(writer.register_channel(topic, "cdr", kind), 2, b"2", 2)
        writer.flush()
        end = file.tell()
    broken = change(cut(path, end, tmp_path), first_chunk(path), tmp_path)
    assert recover(broken, tmp_path / "fixed.mcap") == 0
    said = capsys.readouterr().err
    assert "fixed.mcap: 1 messages" in said
    assert "2 messages cannot be read" in said


@pytest.mark.parametrize("finished", [True, False])
def test_recover_makes_a_file_that_others_read_by_its_index(whole, tmp_path, capsys, finished):
    path, ends = whole
    broken = path if finished else cut(path, ends[3] + 10, tmp_path)
    fixed = tmp_path / "fixed.mcap"
    assert recover(broken, fixed) == 0
    count = (CHUNKS if finished else 4) * EACH
    with fixed.open("rb") as file:
        reader = make_reader(file)
        assert reader.get_summary().statistics.message_count == count
        assert [message.log_time - 1000 for _, _, message in reader.iter_messages()] == list(range(count))
    assert numbers(fixed)[0] == list(range(count))
    said = capsys.readouterr().err
    assert f"fixed.mcap: {count} messages" in said
    assert ("nothing was wrong" if finished else "its last 10 bytes are no whole chunk") in said
