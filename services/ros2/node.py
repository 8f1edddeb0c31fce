"""A node of the ROS 2 graph as rmw_zenoh makes one: liveliness tokens say what it is, keys carry its messages.

Source: the design document of rmw_zenoh. A sample of rmw_zenoh has an attachment: sequence number, time, and the
endpoint's id. Nodes drop samples without.
"""

import struct
import threading
import time
from collections.abc import Callable
from enum import Enum

import xxhash

from cliffscan.common.contract.limits import SMALL
from cliffscan.common.contract.message import MessageError
from cliffscan.common.contract.ros_keys import TOKENS
from cliffscan.common.runtime.foreign_keys import ForeignKeys, ForeignPublisher, Received
from cliffscan.common.runtime.metrics import ServiceMetrics
from cliffscan.services.ros2.cdr import CdrError, Reader
from cliffscan.services.ros2.interfaces import Interface

NODE_ID = 0  # the session has one node
ENCLAVE = "%"  # none
ATTACHMENT = struct.Struct("<qqB16s")
ROOM = 8  # samples that may wait to be read
RATE = 200.0  # [Hz] at which they are
SLASH = "%"  # in a part of a key


class Profile(Enum):
    """A quality of service as a token spells it: reliability, durability, history and depth, and nothing more."""

    SENSOR_DATA = "2:2:1,5:,:,:,,"  # best effort, volatile
    DEFAULT = "1:2:1,10:,:,:,,"  # reliable, volatile
    LATCHED = "1:1:1,1:,:,:,,"  # reliable, transient local


class Publisher:
    """Publishes the messages of one topic; safe to use from any thread."""

    def __init__(self, publisher: ForeignPublisher, gid: bytes) -> None:
        self._publisher = publisher
        self._gid = gid
        self._lock = threading.Lock()
        self._sequence = 0

    @property
    def has_subscribers(self) -> bool:
        """Whether a message would be received; of a latched topic always."""
        return self._publisher.has_subscribers

    def put(self, payload: bytes) -> None:
        """Publish a message's CDR."""
        with self._lock:
            self._sequence += 1
            attachment = ATTACHMENT.pack(self._sequence, time.time_ns(), len(self._gid), self._gid)
            self._publisher.put(payload, attachment)


class Node:
    """One node with its publishers and subscriptions, which other nodes see as long as the session lasts."""

    def __init__(self, keys: ForeignKeys, metrics: ServiceMetrics, name: str, namespace: str, domain: int) -> None:
        self._keys = keys
        self._metrics = metrics
        self._name = name
        self._namespace = f"/{namespace}" if namespace else ""
        self._domain = domain
        self._endpoints = 0

    def announce(self) -> None:
        """Show the node itself to others."""
        self._keys.hold_token(self._token(NODE_ID, "NN"))

    def publisher(self, topic: str, interface: Interface, profile: Profile) -> Publisher:
        """Declare a publisher of `topic`, a name below the node's namespace."""
        key = self._key(topic, interface)
        latched = profile is Profile.LATCHED
        declared = self._keys.latched_publisher(key) if latched else self._keys.publisher(key)
        return Publisher(declared, endpoint_id(self._announce_endpoint("MP", topic, interface, profile)))

    def subscribe(
        self,
        topic: str,
        interface: Interface,
        receive: Callable[[Reader], None],
        profile: Profile = Profile.DEFAULT,
        room: int = ROOM,
        most: int = SMALL,
    ) -> None:
        """Call `receive` with each message of `topic`; what it raises, CdrError or MessageError, is counted.

        room: messages that may wait, of which the oldest is dropped first; most: [bytes] of one.
        """

        def refused(why: Exception) -> None:
            self._metrics.warn_limited("malformed", f"{self._namespace}/{topic}: {why}")

        def take(sample: Received) -> None:
            try:
                receive(Reader(sample.payload, sent_at(sample.attachment)))
            except (CdrError, MessageError) as error:
                refused(error)
            else:
                self._metrics.count("received")

        latched = profile is Profile.LATCHED
        self._keys.subscribe(self._key(topic, interface), take, refused, most, room, RATE, latched)
        self._announce_endpoint("MS", topic, interface, profile)

    def serve(self, name: str, interface: Interface, respond: Callable[[], bytes]) -> None:
        """Answer requests without parameters to the service `name` with the CDR that `respond` makes."""

        def refused(why: Exception) -> None:
            self._metrics.warn_limited("malformed", f"{self._namespace}/{name}: {why}")

        def answer(request: Received) -> Received | None:
            try:
                Reader(request.payload)
                sequence, _time, size, client = ATTACHMENT.unpack(request.attachment or b"")
            except (CdrError, struct.error) as error:
                refused(error)
                return None
            self._metrics.count("received")
            return Received(respond(), ATTACHMENT.pack(sequence, time.time_ns(), size, client))

        self._keys.answer(self._key(name, interface), answer, refused, SMALL, ROOM, RATE)
        self._announce_endpoint("SS", name, interface, Profile.DEFAULT)

    def _announce_endpoint(self, kind: str, topic: str, interface: Interface, profile: Profile) -> str:
        self._endpoints += 1
        full = f"{self._namespace}/{topic}".replace("/", SLASH)
        parts = (full, interface.dds_name, interface.type_hash, profile.value)
        token = self._token(self._endpoints, kind, *parts)
        self._keys.hold_token(token)
        return token

    def _token(self, number: int, kind: str, *parts: str) -> str:
        namespace = (self._namespace or "/").replace("/", SLASH)
        where = (TOKENS, str(self._domain), self._keys.session_id, str(NODE_ID), str(number))
        return "/".join((*where, kind, ENCLAVE, namespace, self._name, *parts))

    def _key(self, topic: str, interface: Interface) -> str:
        path = f"{self._namespace}/{topic}".strip("/")
        return f"{self._domain}/{path}/{interface.dds_name}/{interface.type_hash}"


def sent_at(attachment: bytes | None) -> int:
    """When a sample was sent [ns], by its attachment; 0 where it has none of rmw_zenoh's form, or no time in it."""
    if attachment is None or len(attachment) != ATTACHMENT.size:
        return 0
    sent: int = ATTACHMENT.unpack(attachment)[1]
    return max(sent, 0)


def endpoint_id(token: str) -> bytes:
    """The 16 bytes by which an endpoint is known, from its token; as in rmw_zenoh, low bytes first."""
    return xxhash.xxh3_128_digest(token.encode())[::-1]
