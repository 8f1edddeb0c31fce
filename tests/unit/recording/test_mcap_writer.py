"""Files of our own writer are as good as those of the MCAP project's: its reader checks all sums and finds the same."""

import pytest
from mcap.reader import make_reader
from mcap.records import DataEnd, Footer, SummaryOffset
from mcap.stream_reader import StreamReader
from mcap.writer import Writer

from cliffscan.recording.mcap_writer import McapWriter

METADATA = ("cliffscan", {"robot": "turtlebot"})
SCHEMAS = [("std_msgs/msg/String", b"string data"), ("a_msgs/msg/Empty", b"")]
CHANNELS = [("/first", 1, {"qos": "best"}), ("/second", 2, {}), ("/never", 2, {})]
MESSAGES = [(1, 50, b"one"), (2, 40, b""), (1, 60, bytes(5000)), (2, 60, b"four"), (1, 70, b"five")]  # two out of order
CHUNK = 4096


def ours(path):
    with path.open("wb") as file:
        writer = McapWriter(file, "ros2", "test", CHUNK)
        writer.add_metadata(*METADATA)
        for name, data in SCHEMAS:
            writer.register_schema(name, "ros2msg", data)
        for topic, schema, metadata in CHANNELS:
            writer.register_channel(topic, "cdr", schema, metadata)
        for channel, stamp, payload in MESSAGES:
            writer.add_message(channel, stamp, payload)
        writer.finish()
    return path


def theirs(path):
    with path.open("wb") as file:
        writer = Writer(file, CHUNK)
        writer.start("ros2", "test")
        writer.add_metadata(*METADATA)
        for name, data in SCHEMAS:
            writer.register_schema(name, "ros2msg", data)
        for topic, schema, metadata in CHANNELS:
            writer.register_channel(topic, "cdr", schema, metadata)
        for channel, stamp, payload in MESSAGES:
            writer.add_message(channel, stamp, payload, stamp)
        writer.finish()
    return path


@pytest.fixture
def both(tmp_path):
    return ours(tmp_path / "ours.mcap"), theirs(tmp_path / "theirs.mcap")


def read(path):
    """Summary without places and sizes, and every message by the index."""
    with path.open("rb") as file:
        reader = make_reader(file, validate_crcs=True)
        summary = reader.get_summary()
        spans = [
            (each.message_start_time, each.message_end_time, each.uncompressed_size, set(each.message_index_offsets))
            for each in summary.chunk_indexes
        ]
        found = [(channel.topic, message) for _, channel, message in reader.iter_messages()]
        names = [each.name for each in summary.metadata_indexes]
        metadata = list(reader.iter_metadata())
        return summary.statistics, summary.schemas, summary.channels, spans, found, names, metadata


def test_the_projects_reader_finds_the_same_in_both(both):
    mine, its = map(read, both)
    assert mine == its
    assert len(mine[3]) == 2  # chunks
    assert len(mine[4]) == len(MESSAGES)


def test_the_index_finds_the_messages_of_one_topic_and_time(both):
    for path in both:
        with path.open("rb") as file:
            found = make_reader(file).iter_messages(topics=["/first"], starting_at=60)
            assert [message.data for _, _, message in found] == [bytes(5000), b"five"]


def test_records_follow_each_other_as_in_the_projects_file(both):
    def kinds(path):
        with path.open("rb") as file:
            records = StreamReader(file, emit_chunks=True, validate_crcs=True).records
            return [kind for record in records if (kind := type(record)) is not SummaryOffset]  # of empty groups, too

    mine, its = map(kinds, both)
    assert mine == its
    assert mine[-1] is Footer
    assert DataEnd in mine


def test_a_file_without_messages_is_whole(tmp_path):
    with (tmp_path / "none.mcap").open("wb") as file:
        McapWriter(file, "ros2", "test", CHUNK).finish()
    with (tmp_path / "none.mcap").open("rb") as file:
        assert make_reader(file, validate_crcs=True).get_summary().statistics.message_count == 0
