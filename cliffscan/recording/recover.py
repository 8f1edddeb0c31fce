"""`cliffscan recover BROKEN.mcap FIXED.mcap`: a whole file of what a killed writer left."""

import sys
from pathlib import Path

from mcap.records import Attachment, Channel, Header, Message, Metadata, Schema
from mcap.writer import Writer

from cliffscan.recording.errors import RecordingError
from cliffscan.recording.reading import NO_SCHEMA, McapRecords
from cliffscan.recording.words import duration, size


def recover(broken: Path, fixed: Path) -> int:
    """Copy every message that can be read, of any MCAP file; 1 where none can.

    Raises RecordingError, FileExistsError and OSError.
    """
    records = McapRecords(broken)
    if not isinstance(next(iter(records), None), Header):
        raise RecordingError(f"{broken} holds no whole record: there is nothing to recover")
    with fixed.open("xb") as file:
        writer = _Copy(Writer(file))
        for record in records:
            writer.add(record)
        writer.finish()
    span = duration((writer.last - writer.first) * 1e-9) if writer.messages else duration(0.0)
    print(f"cliffscan: {fixed}: {writer.messages} messages, {span}, {size(fixed.stat().st_size)}", file=sys.stderr)
    damage = records.damage.words
    print(f"cliffscan: {broken}: {damage or 'nothing was wrong'}", file=sys.stderr)
    return 1 if damage and not writer.messages else 0


class _Copy:
    """Writes records of one file into another, schemas and channels once."""

    def __init__(self, writer: Writer) -> None:
        self._writer = writer
        self._schemas = {NO_SCHEMA: NO_SCHEMA}
        self._channels: dict[int, int] = {}
        self.messages = 0
        self.first = self.last = 0  # [ns]

    def add(self, record: object) -> None:
        """Copy a record; what only indexes others is made anew."""
        match record:
            case Header():
                self._writer.start(record.profile, record.library)
            case Schema() if record.id not in self._schemas:
                self._schemas[record.id] = self._writer.register_schema(record.name, record.encoding, record.data)
            case Channel() if record.id not in self._channels:
                schema = self._schemas[record.schema_id]
                self._channels[record.id] = self._writer.register_channel(
                    record.topic, record.message_encoding, schema, record.metadata
                )
            case Message():
                self._message(record, self._channels[record.channel_id])
            case Metadata():
                self._writer.add_metadata(record.name, record.metadata)
            case Attachment():
                self._writer.add_attachment(
                    record.create_time, record.log_time, record.name, record.media_type, record.data
                )

    def finish(self) -> None:
        """Write what a whole file ends with."""
        self._writer.finish()

    def _message(self, message: Message, channel: int) -> None:
        self._writer.add_message(channel, message.log_time, message.data, message.publish_time, message.sequence)
        self.first = min(self.first, message.log_time) if self.messages else message.log_time
        self.last = max(self.last, message.log_time)
        self.messages += 1
