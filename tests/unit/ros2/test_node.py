"""What a node hands over of the samples that it receives."""

import struct

import pytest

from cliffscan.common.runtime.foreign_keys import Received
from cliffscan.common.runtime.metrics import ServiceMetrics
from cliffscan.services.ros2 import interfaces, messages
from cliffscan.services.ros2.node import Node

SENT = 1_700_000_000_123_456_789  # [ns]
GID = bytes(range(16))


class Keys:
    """Stands in for ForeignKeys; `take` is what its samples are given to."""

    session_id = "a"

    def hold_token(self, key):
        pass

    def subscribe(self, _key, take, *_):
        self.take = take


def attachment(sent):
    """As rmw_zenoh writes it, packed field by field."""
    return struct.pack("<q", 7) + struct.pack("<q", sent) + bytes([len(GID)]) + GID


@pytest.mark.parametrize(
    ("attached", "sent"),
    [
        (attachment(SENT), SENT),
        (attachment(0), 0),
        (attachment(-5), 0),
        (attachment(SENT)[:-1], 0),
        (attachment(SENT) + b"0", 0),
        (b"", 0),
        (None, 0),
    ],
)
def test_a_message_tells_when_it_was_sent(attached, sent):
    keys, told = Keys(), []
    node = Node(keys, ServiceMetrics(), "cliffscan", "", 0)
    node.subscribe("cmd_vel", interfaces.TWIST, lambda reader: told.append(reader.sent))
    keys.take(Received(messages.twist(0.5, 0.0), attached))
    assert told == [sent]
