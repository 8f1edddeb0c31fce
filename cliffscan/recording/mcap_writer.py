"""Writes MCAP files of chunks with an index, for a recorder that lives beside a robot.

The library's own Writer takes some forty calls for each message, and compresses at zstandard's level 3: a third of what
writing cost. Here a message is one call of struct; the library's classes write all other records.

Source: the MCAP specification, version 0.
"""

import struct
import zlib
from collections import Counter, defaultdict
from collections.abc import Iterable
from typing import BinaryIO

import zstandard
from mcap.data_stream import RecordBuilder
from mcap.opcode import Opcode
from mcap.records import (
    Channel,
    Chunk,
    ChunkIndex,
    DataEnd,
    Footer,
    Header,
    McapRecord,
    Metadata,
    MetadataIndex,
    Schema,
    Statistics,
    SummaryOffset,
)
from mcap.writer import MCAP0_MAGIC

LEVEL = 2  # of zstandard: half the time of its usual 3, and no larger
MESSAGE = struct.Struct("<BQHIQQ")  # opcode, length of the rest, channel, number, times of record and publication
INDEX = struct.Struct("<BQHI")  # opcode, length of the rest, channel, length of the times and places
OPENING = struct.calcsize("<BQ")  # [bytes] of a record before what its length counts
FOOTER = struct.Struct("<BQQQ")  # opcode, length of the rest, and where the summary and its offsets begin
CHECKED_FOOTER = 20  # [bytes] of a footer with its check sum


class McapWriter:
    """Writes messages in the order in which they come. Nothing is in the file before flush() or finish()."""

    def __init__(self, file: BinaryIO, profile: str, library: str, chunk_size: int) -> None:
        """chunk_size: [bytes] after which a chunk is written by itself."""
        self._file, self._chunk_size = file, chunk_size
        self._compress = zstandard.ZstdCompressor(LEVEL).compress
        self._chunk = bytearray()
        self._places: defaultdict[int, list[int]] = defaultdict(list)  # of a channel's messages: time, place, time, …
        self._schemas: list[Schema] = []
        self._channels: list[Channel] = []
        self._metadata: list[MetadataIndex] = []
        self._chunks: list[ChunkIndex] = []
        self._counts: Counter[int] = Counter()
        file.write(MCAP0_MAGIC)
        file.write(_bytes(Header(profile=profile, library=library)))

    def add_metadata(self, name: str, values: dict[str, str]) -> None:
        """A record of names and values, which stands outside the chunks."""
        record = _bytes(Metadata(name=name, metadata=values))
        self._metadata.append(MetadataIndex(offset=self._file.tell(), length=len(record), name=name))
        self._file.write(record)

    def register_schema(self, name: str, encoding: str, data: bytes) -> int:
        """A schema's number."""
        schema = Schema(id=len(self._schemas) + 1, name=name, encoding=encoding, data=data)
        self._schemas.append(schema)
        self._chunk += _bytes(schema)
        return schema.id

    def register_channel(self, topic: str, encoding: str, schema: int, metadata: dict[str, str]) -> int:
        """A channel's number."""
        number = len(self._channels) + 1
        channel = Channel(id=number, topic=topic, message_encoding=encoding, schema_id=schema, metadata=metadata)
        self._channels.append(channel)
        self._chunk += _bytes(channel)
        return number

    def add_message(self, channel: int, stamp: int, payload: bytes) -> None:
        """A message that came at `stamp` [ns]."""
        self._places[channel] += (stamp, len(self._chunk))
        length = MESSAGE.size - OPENING + len(payload)
        self._chunk += MESSAGE.pack(Opcode.MESSAGE, length, channel, 0, stamp, stamp)
        self._chunk += payload
        if len(self._chunk) >= self._chunk_size:
            self.flush()

    def flush(self) -> None:
        """Write what was added, as a chunk of its own."""
        if self._places:
            self._write_chunk()
            self._chunk.clear()
            self._places.clear()
        self._file.flush()

    def finish(self) -> None:
        """Write the rest, and the summary by which a file is read in any order. The file stays open."""
        self.flush()
        self._file.write(_bytes(DataEnd(data_section_crc=0)))
        start = self._file.tell()
        summary, offsets = bytearray(), []
        groups: list[tuple[Opcode, Iterable[McapRecord]]] = [
            (Opcode.SCHEMA, self._schemas),
            (Opcode.CHANNEL, self._channels),
            (Opcode.STATISTICS, [self._statistics()]),
            (Opcode.CHUNK_INDEX, self._chunks),
            (Opcode.METADATA_INDEX, self._metadata),
        ]
        for opcode, records in groups:
            group = b"".join(map(_bytes, records))
            offset = SummaryOffset(group_opcode=opcode, group_start=start + len(summary), group_length=len(group))
            offsets.append(_bytes(offset))
            summary += group
        offsets_start = start + len(summary)
        summary += b"".join(offsets)
        opening = FOOTER.pack(Opcode.FOOTER, CHECKED_FOOTER, start, offsets_start)
        check = zlib.crc32(opening, zlib.crc32(summary))
        self._file.write(summary)
        self._file.write(_bytes(Footer(summary_start=start, summary_offset_start=offsets_start, summary_crc=check)))
        self._file.write(MCAP0_MAGIC)

    def _write_chunk(self) -> None:
        first = min(min(places[::2]) for places in self._places.values())
        last = max(max(places[::2]) for places in self._places.values())
        compressed, size = self._compress(self._chunk), len(self._chunk)
        record = _bytes(
            Chunk(
                compression="zstd",
                data=compressed,
                message_start_time=first,
                message_end_time=last,
                uncompressed_crc=zlib.crc32(self._chunk),
                uncompressed_size=size,
            )
        )
        start = self._file.tell()
        index, offsets = bytearray(), {}
        for channel, places in self._places.items():
            offsets[channel] = start + len(record) + len(index)
            times = struct.pack(f"<{len(places)}Q", *places)
            index += INDEX.pack(Opcode.MESSAGE_INDEX, INDEX.size - OPENING + len(times), channel, len(times)) + times
            self._counts[channel] += len(places) // 2
        self._file.write(record)
        self._file.write(index)
        self._chunks.append(
            ChunkIndex(
                message_start_time=first,
                message_end_time=last,
                chunk_start_offset=start,
                chunk_length=len(record),
                message_index_offsets=offsets,
                message_index_length=len(index),
                compression="zstd",
                compressed_size=len(compressed),
                uncompressed_size=size,
            )
        )

    def _statistics(self) -> Statistics:
        return Statistics(
            attachment_count=0,
            channel_count=len(self._channels),
            channel_message_counts=dict(self._counts),
            chunk_count=len(self._chunks),
            message_count=self._counts.total(),
            message_end_time=max((each.message_end_time for each in self._chunks), default=0),
            message_start_time=min((each.message_start_time for each in self._chunks), default=0),
            metadata_count=len(self._metadata),
            schema_count=len(self._schemas),
        )


def _bytes(record: McapRecord) -> bytes:
    builder = RecordBuilder()
    record.write(builder)
    data: bytes = builder.end()
    return data
