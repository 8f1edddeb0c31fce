"""What a killed writer left is read up to its last whole chunk, and mended."""

import pytest
from mcap.reader import make_reader

from cliffscan.common.runtime.raw_samples import RawSample
from cliffscan.recording.parts import Limits, Parts
from cliffscan.recording.reading import Recording
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
    data = bytearray(path.read_bytes())
    data[ends[1] + 60] ^= 0xFF  # in the third chunk's data
    changed = tmp_path / "changed.mcap"
    changed.write_bytes(data)
    found, damage = numbers(changed)
    assert found == [each for each in range(CHUNKS * EACH) if not 2 * EACH <= each < 3 * EACH]
    assert damage.words == "1 chunks hold something else than they should"


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
