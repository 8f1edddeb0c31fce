"""A ROS 2 node of somebody else's over rmw_zenoh: plain Zenoh, and messages by rosbags. It shares no code with ros2."""

import queue
import struct
import threading
import time

import zenoh
import zenoh.ext
from rosbags.typesys import Stores, get_typestore

ROS = get_typestore(Stores.ROS2_JAZZY)
DEADLINE = 60.0  # [s] after which a fact that did not come will not come
LIVELINESS = "@ros2_lv"


def key_of(topic, name, domain=0):
    """The key of a topic's samples of type `name`, as geometry_msgs/msg/Twist."""
    package, _, kind = name.split("/")
    return f"{domain}/{topic.strip('/')}/{package}::msg::dds_::{kind}_/{ROS.hash_rihs01(name)}"


class Subscription:
    """What is published on a topic, decoded; `raw` has (payload, attachment) too."""

    def __init__(self, session, topic, name, latched=False, domain=0) -> None:
        self._name = name
        self._heard = queue.Queue()
        key = key_of(topic, name, domain)
        if latched:
            history = zenoh.ext.HistoryConfig(detect_late_publishers=True)
            recovery = zenoh.ext.RecoveryConfig(heartbeat=True)
            self._source = zenoh.ext.declare_advanced_subscriber(
                session, key, self._take, history=history, recovery=recovery
            )
        else:
            self._source = session.declare_subscriber(key, self._take)

    def _take(self, sample):
        self._heard.put((sample.payload.to_bytes(), sample.attachment.to_bytes()))

    def raw(self):
        """The next sample's bytes: payload and attachment."""
        return self._heard.get(timeout=DEADLINE)

    def get(self):
        """The next message."""
        return ROS.deserialize_cdr(self.raw()[0], self._name)

    def close(self):
        self._source.undeclare()


class Peer:
    """A session like that of a ROS node, which a router leads to the others.

    file: its Zenoh file; domain: of which it sees the graph, all where it is a wild card.
    """

    def __init__(self, endpoint, file=None, domain="*") -> None:
        config = zenoh.Config.from_file(str(file)) if file else zenoh.Config()
        config.insert_json5("connect/endpoints", f'["{endpoint}"]')
        config.insert_json5("scouting/multicast/enabled", "false")
        self.session = zenoh.open(config)
        self._tokens = set()
        self._changed = threading.Condition()
        self.session.liveliness().declare_subscriber(f"{LIVELINESS}/{domain}/**", self._token, history=True)
        self._sequence = 0

    def _token(self, sample):
        with self._changed:
            change = self._tokens.add if sample.kind == zenoh.SampleKind.PUT else self._tokens.discard
            change(str(sample.key_expr))
            self._changed.notify_all()

    def tokens_when(self, holds):
        """All tokens of the graph, each in parts, as soon as `holds` is true of them."""
        with self._changed:
            parts = []

            def fulfilled():
                parts[:] = [token.split("/") for token in self._tokens]
                return holds(parts)

            assert self._changed.wait_for(fulfilled, DEADLINE), self._tokens
            return parts

    def subscribe(self, topic, name, latched=False, domain=0):
        return Subscription(self.session, topic, name, latched, domain)

    def publish(self, topic, name, message, domain=0, sent=None):
        """Publish as rmw_zenoh does, with an attachment. sent [ns]: the time in it, None for now."""
        self._sequence += 1
        attachment = struct.pack("<qqB16s", self._sequence, sent or time.time_ns(), 16, bytes(range(16)))
        payload = bytes(ROS.serialize_cdr(message, name))
        self.session.put(
            key_of(topic, name, domain),
            payload,
            attachment=attachment,
            congestion_control=zenoh.CongestionControl.BLOCK,
        )

    def publish_once(self, topic, name, message, sent=None):
        """Publish as soon as somebody subscribes, for what is not published again."""
        publisher = self.session.declare_publisher(key_of(topic, name))
        deadline = time.monotonic() + DEADLINE
        while not publisher.matching_status.matching:
            assert time.monotonic() < deadline
            threading.Event().wait(0.01)
        self.publish(topic, name, message, sent=sent)

    def close(self):
        self.session.close()
