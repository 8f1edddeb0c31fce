"""A robot's samples as they are: bytes and what comes with them, neither decoded nor checked but for their size."""

import threading
import time
from collections.abc import Callable, Sequence
from functools import lru_cache
from typing import Any, NamedTuple

import zenoh

from cliffscan.common.contract.message import MessageError, check_size
from cliffscan.common.contract.topics import Qos, most_bytes, topic_at
from cliffscan.common.runtime.qos import declare_publisher
from cliffscan.common.runtime.reader import Readers

REQUESTS = 8  # that may wait at a key


class RawSample(NamedTuple):
    """What was put on a key."""

    path: str  # below the robot's name
    encoding: str  # Zenoh's, with its schema
    received: int  # [ns] since the Unix epoch, when it came
    attachment: bytes
    payload: bytes


class RawPublisher:
    """Puts samples on one key."""

    def __init__(self, publisher: zenoh.Publisher) -> None:
        self._publisher = publisher

    def put(self, sample: RawSample) -> None:
        """Send a sample's payload and attachment; it is dropped where a link is full."""
        self._publisher.put(sample.payload, attachment=sample.attachment or None)


class RawSamples:
    """Receives and publishes the samples of one robot. Session and readers are the bus's, and so is their end."""

    def __init__(self, session: zenoh.Session, readers: Readers, robot: str) -> None:
        self._session = session
        self._readers = readers
        self._robot = robot
        self._declared: list[Any] = []

    def subscribe(
        self,
        path: str,
        receive: Callable[[RawSample], object],
        refused: Callable[[str, MessageError], object],
        room: int,
    ) -> None:
        """Call `receive` for every sample on `path`; `*` and `**` are wild. `refused(path, why)`: it was too large.

        `room` samples may wait; beyond, the oldest is dropped, uncounted.
        """
        prefix = len(self._robot) + 1

        def take(sample: zenoh.Sample) -> None:
            if sample.kind != zenoh.SampleKind.PUT:
                return
            received, at, payload = time.time_ns(), str(sample.key_expr)[prefix:], sample.payload
            try:
                check_size(len(payload), most_bytes(at))
            except MessageError as error:
                refused(at, error)
                return
            attached = sample.attachment
            attachment = attached.to_bytes() if attached else b""
            receive(RawSample(at, str(sample.encoding), received, attachment, payload.to_bytes()))

        source = self._session.declare_subscriber(f"{self._robot}/{path}", zenoh.handlers.RingChannel(room))
        self._declared.append(source)
        self._readers.read(source, take)

    def publisher(self, path: str, encoding: str) -> RawPublisher:
        """Declare that samples of an encoding will be put on `path`, which travel as the contract has it."""
        topic = topic_at(path)
        qos = topic.qos if topic else Qos.STATUS
        publisher = declare_publisher(self._session, f"{self._robot}/{path}", zenoh.Encoding(encoding), qos)
        self._declared.append(publisher)
        return RawPublisher(publisher)

    def latch(self, path: str) -> Callable[[RawSample], None]:
        """Keep samples of `path`, one of each payload, for whoever asks later; what is returned takes one more."""
        key = f"{self._robot}/{path}"
        kept: dict[bytes, RawSample] = {}
        lock = threading.Lock()

        def keep(sample: RawSample) -> None:
            with lock:
                kept.pop(sample.payload, None)  # the newest is the last
                kept[sample.payload] = sample

        def take(query: zenoh.Query) -> None:
            with query, lock:
                for sample in kept.values():
                    query.reply(key, sample.payload, encoding=zenoh.Encoding(sample.encoding))

        source = self._session.declare_queryable(key, zenoh.handlers.RingChannel(REQUESTS))
        self._declared.append(source)
        self._readers.read(source, take)
        return keep


def key_matcher(patterns: Sequence[str]) -> Callable[[str], bool]:
    """Whether a path is on one of these keys, in which `*` and `**` are wild. Raises ValueError for what is no key."""
    keys = [_key(pattern) for pattern in patterns]

    @lru_cache(1024)
    def matches(path: str) -> bool:
        return any(key.includes(zenoh.KeyExpr(path)) for key in keys)

    return matches


def _key(pattern: str) -> zenoh.KeyExpr:
    try:
        return zenoh.KeyExpr(pattern)
    except zenoh.ZError as error:
        raise ValueError(f"{pattern!r} is no key: write it below the robot's name, as scan/fused or scan/**") from error
