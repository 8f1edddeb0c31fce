"""A viewer that speaks Foxglove's WebSocket protocol, written from its specification and from nothing of ours.

Source: docs/spec.md of github.com/foxglove/ws-protocol.
"""

import json
import struct

from rosbags.typesys import Stores, get_types_from_msg, get_typestore
from websockets.sync.client import connect

DEADLINE = 60.0  # [s]
MESSAGE_DATA = 0x01
PROTOCOL = "foxglove.sdk.v1"


def opening(address):
    """A context manager: the socket of a viewer."""
    return connect(address, subprotocols=[PROTOCOL], max_size=None)


class FoxgloveViewer:
    """Knows a channel by its topic, and reads messages by the schemas that the server gives."""

    def __init__(self, socket) -> None:
        self.socket = socket
        assert socket.subprotocol == PROTOCOL
        self.info = self._operation("serverInfo")
        self.channels = {channel["topic"]: channel for channel in self._operation("advertise")["channels"]}
        self._subscribed = {}
        self._types = get_typestore(Stores.EMPTY)
        for channel in self.channels.values():
            assert (channel["encoding"], channel["schemaEncoding"]) == ("cdr", "ros2msg")
            self._types.register(get_types_from_msg(channel["schema"], channel["schemaName"]))

    def _operation(self, name):
        """The next JSON message, which must be this one."""
        message = json.loads(self.socket.recv(timeout=DEADLINE))
        assert message["op"] == name
        return message

    def send(self, **message):
        self.socket.send(json.dumps(message))

    def subscribe(self, number, topic):
        self._subscribed[number] = self.channels[topic]
        wanted = [{"id": number, "channelId": self.channels[topic]["id"]}]
        self.send(op="subscribe", subscriptions=wanted)

    def unsubscribe(self, number):
        self.send(op="unsubscribe", subscriptionIds=[number])

    def receive(self):
        """The next message: its subscription, its time [ns] and its fields; or a JSON message, as a map."""
        data = self.socket.recv(timeout=DEADLINE)
        if isinstance(data, str):
            return json.loads(data)
        opcode, number, stamp = struct.unpack_from("<BIQ", data)
        assert opcode == MESSAGE_DATA
        return number, stamp, self._types.deserialize_cdr(data[13:], self._subscribed[number]["schemaName"])
