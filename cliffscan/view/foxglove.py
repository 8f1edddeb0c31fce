"""The robot for viewers that speak Foxglove's WebSocket protocol, as Foxglove and Lichtblick do: topics of ROS, as CDR.

Source: docs/spec.md of github.com/foxglove/ws-protocol; `foxglove.sdk.v1` is the same for what is used of it here.
"""

import json
import struct
import threading
from collections.abc import Callable
from typing import Any

from websockets.exceptions import ConnectionClosed
from websockets.sync.server import ServerConnection

from cliffscan.recording.definitions import schema
from cliffscan.view.feeds import Feeds, Sample
from cliffscan.view.foxglove_channels import Channel, Source, channels
from cliffscan.view.outbox import Outbox
from cliffscan.view.sending import send_all

SUBPROTOCOLS = ("foxglove.sdk.v1", "foxglove.websocket.v1")
MESSAGE_DATA = 1  # opcode
PREFIX = struct.Struct("<BIQ")  # opcode, subscription, stamp [ns]
WARNING = 1  # level of a status


class FoxgloveClient:
    """A socket of such a viewer. What it does not subscribe to is neither received nor converted."""

    def __init__(self, connection: ServerConnection, feeds: Feeds) -> None:
        self._connection = connection
        self._feeds = feeds
        self._channels = dict(enumerate(channels(), start=1))
        self._outbox = Outbox({}, outstanding=None)
        self._cancel: dict[int, list[Callable[[], None]]] = {}  # by subscription

    def run(self) -> None:
        """Serve the viewer until it leaves."""
        sender = threading.Thread(target=self._send, name="foxglove sender", daemon=True)
        sender.start()
        try:
            self._connection.send(json.dumps(self._info()))
            self._connection.send(json.dumps({"op": "advertise", "channels": self._advertised()}))
            for text in self._connection:
                self._receive(text)
        except ConnectionClosed:
            pass
        finally:
            self._unsubscribe(list(self._cancel))
            self._outbox.close()

    def _info(self) -> dict[str, object]:
        return {
            "op": "serverInfo",
            "name": f"cliffscan: {self._feeds.robot}",
            "capabilities": [],
            "supportedEncodings": ["cdr"],
            "metadata": {"robot": self._feeds.robot},
        }

    def _advertised(self) -> list[dict[str, object]]:
        return [
            {
                "id": number,
                "topic": channel.topic,
                "encoding": "cdr",
                "schemaName": channel.schema,
                "schemaEncoding": "ros2msg",
                "schema": schema(channel.schema),
            }
            for number, channel in self._channels.items()
        ]

    def _receive(self, text: str | bytes) -> None:
        try:
            asked: Any = json.loads(text)
        except ValueError:
            asked = None
        match asked:
            case {"op": "subscribe", "subscriptions": [*wanted]}:
                for each in wanted:
                    self._subscribe(each)
            case {"op": "unsubscribe", "subscriptionIds": [*numbers]}:
                self._unsubscribe([number for number in numbers if isinstance(number, int)])
            case _:
                self._warn("this server takes subscribe and unsubscribe only")

    def _subscribe(self, wanted: object) -> None:
        match wanted:
            case {"id": int(number), "channelId": int(channel)} if (
                channel in self._channels and 0 <= number < 2**32 and number not in self._cancel
            ):
                self._cancel[number] = self._listen(number, self._channels[channel])
            case _:
                self._warn(f"no subscription: {str(wanted)[:100]}: expected a new id and the id of a channel")

    def _listen(self, number: int, channel: Channel) -> list[Callable[[], None]]:
        def receiver(place: int, source: Source[Any]) -> Callable[[Sample[Any]], None]:
            return lambda sample: self._outbox.offer(f"{number} {place}", lambda: _data(number, source, sample))

        return [
            self._feeds.listen(source.topic, receiver(place, source)) for place, source in enumerate(channel.sources)
        ]

    def _unsubscribe(self, numbers: list[int]) -> None:
        for number in numbers:
            for cancel in self._cancel.pop(number, []):
                cancel()

    def _warn(self, why: str) -> None:
        self._connection.send(json.dumps({"op": "status", "level": WARNING, "message": why}))

    def _send(self) -> None:
        send_all(self._outbox, lambda _number, body: self._connection.send(body))


def _data(number: int, source: Source[Any], sample: Sample[Any]) -> bytes | None:
    """The message data of a sample, or None where nothing is made of it. Raises MessageError, CdrError."""
    message = sample.message
    payload = source.convert(message)
    return PREFIX.pack(MESSAGE_DATA, number, message.stamp) + payload if payload else None
