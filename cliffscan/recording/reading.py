"""Reads recordings in the order they were written, also those whose writer was killed."""

import struct
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import NamedTuple

from mcap.exceptions import McapError
from mcap.reader import make_reader
from mcap.records import Channel, Chunk, Header, McapRecord, Message, MessageIndex, Metadata, Schema
from mcap.stream_reader import CRCValidationError, StreamReader, breakup_chunk
from zstandard import ZstdError

from cliffscan.common.contract.topics import ROBOT_NAME
from cliffscan.common.runtime.raw_samples import RawSample
from cliffscan.recording.envelope import NATIVE, unwrap
from cliffscan.recording.errors import RecordingError
from cliffscan.recording.mcap_file import METADATA
from cliffscan.services.ros2.cdr import CdrError

NO_SCHEMA = 0  # of a channel that has none
MAGIC = b"\x89MCAP0\r\n"
DAMAGE = (McapError, CRCValidationError, ZstdError, ValueError, RuntimeError, struct.error)


class Damage(NamedTuple):
    """What of a file cannot be read."""

    chunks: int = 0  # whole ones that hold something else than they should
    rest: int = 0  # [bytes] at the end after the last whole record
    finished: bool = True  # whether the writer came to an end
    messages: int = 0  # that were in those chunks, or whose channel was

    @property
    def words(self) -> str:
        """What is wrong, for people; nothing of a whole file."""
        said = [] if self.finished else ["its writer did not finish it"]
        if self.rest:
            said.append(f"its last {self.rest} bytes are no whole chunk")
        if self.chunks:
            said.append(f"{self.chunks} chunks hold something else than they should")
        if self.messages:
            said.append(f"{self.messages} messages cannot be read")
        return ", ".join(said)


class McapRecords:
    """The records of an MCAP file; those of a chunk that cannot be read are left out. `damage` is true at the end."""

    def __init__(self, path: Path) -> None:
        """Raises RecordingError where there is no MCAP file."""
        self.path = path
        self.damage = Damage()
        try:
            with path.open("rb") as file:
                begins = file.read(len(MAGIC))
        except OSError as error:
            raise RecordingError(f"{path}: {error.strerror}") from error
        if begins != MAGIC:
            raise RecordingError(f"{path} is no MCAP file: it does not begin as one")

    def __iter__(self) -> Iterator[McapRecord]:
        """All records in the order they were written, without chunks around them.

        After a chunk that cannot be read come the schemas and channels of the summary, where there is one: theirs may
        have been in it. A channel without its schema and a message without its channel are left out.
        """
        known = _Known()
        chunks = indexed = whole = 0
        readable = finished = True
        with self.path.open("rb") as file:
            records = StreamReader(file, emit_chunks=True).records
            while True:
                whole = file.tell()
                try:
                    record = next(records)
                except StopIteration:
                    break
                except DAMAGE:
                    finished = False
                    break
                if isinstance(record, Chunk):
                    inside = _inside(record)
                    readable = inside is not None
                    chunks += not readable
                    yield from known.of(self._kinds() if inside is None else inside)
                else:
                    if isinstance(record, MessageIndex) and not readable:  # of the chunk before it
                        indexed += len(record.records)
                    yield from known.of([record])
        rest = 0 if finished else self.path.stat().st_size - whole
        self.damage = Damage(chunks, rest, finished, indexed + known.strangers)

    def _kinds(self) -> list[McapRecord]:
        """All schemas and channels, as the summary at the end of a finished file has them."""
        with self.path.open("rb") as file:
            try:
                summary = make_reader(file).get_summary()
            except (*DAMAGE, StopIteration, OSError):
                return []
        return [*summary.schemas.values(), *summary.channels.values()] if summary else []


class _Known:
    """Schemas and channels that have been read."""

    def __init__(self) -> None:
        self.strangers = 0  # messages of a channel that is not known
        self._schemas = {NO_SCHEMA}
        self._channels: set[int] = set()

    def of(self, records: Iterable[McapRecord]) -> Iterator[McapRecord]:
        """The records that can be understood."""
        for record in records:
            match record:
                case Schema():
                    self._schemas.add(record.id)
                case Channel() if record.schema_id in self._schemas:
                    self._channels.add(record.id)
                case Channel():
                    continue
                case Message() if record.channel_id not in self._channels:
                    self.strangers += 1
                    continue
            yield record


def _inside(chunk: Chunk) -> list[McapRecord] | None:
    """The records of a chunk; None where it holds something else than it should."""
    try:
        return breakup_chunk(chunk, validate_crc=True)
    except DAMAGE:
        return None


class Recording:
    """What `cliffscan record` wrote."""

    def __init__(self, path: Path) -> None:
        """Raises RecordingError where it was not `cliffscan record` that wrote the file."""
        self._records = McapRecords(path)
        self.robot = self._robot(path)

    @property
    def damage(self) -> Damage:
        """What could not be read, once samples() is through."""
        return self._records.damage

    def samples(self) -> Iterator[RawSample]:
        """The robot's samples, in the order they came. Raises RecordingError for one that is none."""
        topics: dict[int, str] = {}
        for record in self._records:
            if isinstance(record, Channel):
                topics[record.id] = record.topic
            elif isinstance(record, Message) and topics.get(record.channel_id) == NATIVE.name:
                try:
                    yield unwrap(self.robot, record.data)
                except CdrError as error:
                    raise RecordingError(f"{self._records.path}: {error}") from error

    def _robot(self, path: Path) -> str:
        for record in self._records:
            if isinstance(record, Metadata) and record.name == METADATA:
                robot = record.metadata.get("robot", "")
                if ROBOT_NAME.fullmatch(robot):
                    return robot
            if not isinstance(record, Header | Metadata | Schema):
                break
        raise RecordingError(f"{path} was not made by `cliffscan record`: play it with the program that made it")
