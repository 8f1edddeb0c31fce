"""Keys of another protocol on a bus's session: nothing of this contract, neither the robot's name nor msgpack."""

from collections.abc import Callable
from typing import Any, NamedTuple, Protocol

import zenoh
import zenoh.ext

from cliffscan.common.contract.message import MessageError, check_size
from cliffscan.common.runtime.pace import Pace
from cliffscan.common.runtime.reader import Readers

HEARTBEAT = 0.5  # [s] after which receivers of a latched key are told which sample was the last


class Received(NamedTuple):
    """A foreign sample. It was put by anybody, and nothing is checked but its size."""

    payload: bytes
    attachment: bytes | None


class ForeignPublisher(Protocol):
    """Publishes bytes on one foreign key."""

    @property
    def has_subscribers(self) -> bool:
        """Whether anybody subscribes; of a latched key True, for somebody may later."""

    def put(self, payload: bytes, attachment: bytes) -> None:
        """Send a sample; it is dropped where a link is full."""


class ForeignKeys:
    """Declares foreign keys and tokens. Session and readers are the bus's, and so is their end, unless retract() is."""

    def __init__(self, session: zenoh.Session, readers: Readers) -> None:
        self._session = session
        self._readers = readers
        self._declared: list[Any] = []

    @property
    def session_id(self) -> str:
        """The session's Zenoh id, hexadecimal."""
        return str(self._session.zid())

    def hold_token(self, key: str) -> None:
        """Declare a liveliness token, until the session ends."""
        self._declared.append(self._session.liveliness().declare_token(key))

    def retract(self) -> None:
        """Take back the tokens and subscriptions that were declared here."""
        while self._declared:
            self._declared.pop().undeclare()

    def publisher(self, key: str) -> ForeignPublisher:
        """Declare that samples will be put on a key."""
        return _Publisher(
            self._session.declare_publisher(key, congestion_control=zenoh.CongestionControl.DROP, express=True)
        )

    def latched_publisher(self, key: str) -> ForeignPublisher:
        """Declare a key whose last sample whoever subscribes later gets, by Zenoh's advanced publication."""
        return _LatchedPublisher(
            zenoh.ext.declare_advanced_publisher(
                self._session,
                key,
                congestion_control=zenoh.CongestionControl.DROP,
                cache=zenoh.ext.CacheConfig(1),
                sample_miss_detection=zenoh.ext.MissDetectionConfig(heartbeat=None, sporadic_heartbeat=HEARTBEAT),
                publisher_detection=True,
            )
        )

    def subscribe(
        self,
        key: str,
        receive: Callable[[Received], object],
        refused: Callable[[MessageError], object],
        most: int,
        room: int,
        rate: float,
        latched: bool = False,
    ) -> None:
        """Call `receive` for the samples on a key, at most `rate` [Hz]; `refused` for those of more than `most` bytes.

        `room` samples may wait; beyond, the oldest is dropped. latched: also for what was published before and is kept.
        """

        def take(sample: zenoh.Sample) -> None:
            if sample.kind != zenoh.SampleKind.PUT:
                return
            try:
                check_size(len(sample.payload), most)
            except MessageError as error:
                refused(error)
            else:
                attachment = sample.attachment.to_bytes() if sample.attachment else None
                receive(Received(sample.payload.to_bytes(), attachment))

        ring: zenoh.handlers.RingChannel[zenoh.Sample] = zenoh.handlers.RingChannel(room)
        source = self._latched(key, ring) if latched else self._session.declare_subscriber(key, ring)
        self._declared.append(source)
        self._readers.read(source, take, Pace(rate, room))

    def answer(
        self,
        key: str,
        reply: Callable[[Received], Received | None],
        refused: Callable[[MessageError], object],
        most: int,
        room: int,
        rate: float,
    ) -> None:
        """Answer requests at a key with what `reply` makes of them, nothing where that is None; as subscribe() else.

        A request by a wild card is not answered: nothing is done that was not asked for by name.
        """

        def take(query: zenoh.Query) -> None:
            with query:
                if str(query.key_expr) != key:
                    return
                payload = query.payload
                try:
                    check_size(len(payload) if payload else 0, most)
                except MessageError as error:
                    refused(error)
                    return
                attachment = query.attachment.to_bytes() if query.attachment else None
                answered = reply(Received(payload.to_bytes() if payload else b"", attachment))
                if answered:
                    query.reply(key, answered.payload, attachment=answered.attachment)

        source = self._session.declare_queryable(key, zenoh.handlers.RingChannel(room), complete=True)
        self._declared.append(source)
        self._readers.read(source, take, Pace(rate, room))

    def _latched(self, key: str, ring: Any) -> Any:  # noqa: ANN401
        return zenoh.ext.declare_advanced_subscriber(
            self._session,
            key,
            ring,
            history=zenoh.ext.HistoryConfig(detect_late_publishers=True),
            recovery=zenoh.ext.RecoveryConfig(periodic_queries=None, heartbeat=True),
        )


class _Publisher:
    """Zenoh tells it who subscribes: to ask at each sample costs as much as to convert one."""

    def __init__(self, publisher: zenoh.Publisher) -> None:
        self.has_subscribers = False
        self._publisher = publisher
        self._listener = publisher.declare_matching_listener(self._matched)

    def _matched(self, status: zenoh.MatchingStatus) -> None:
        self.has_subscribers = status.matching

    def put(self, payload: bytes, attachment: bytes) -> None:
        self._publisher.put(payload, attachment=attachment)


class _LatchedPublisher:
    has_subscribers = True

    def __init__(self, publisher: zenoh.ext.AdvancedPublisher) -> None:
        self._publisher = publisher

    def put(self, payload: bytes, attachment: bytes) -> None:
        self._publisher.put(payload, attachment=attachment)
