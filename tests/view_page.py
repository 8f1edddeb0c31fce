"""A page without a browser: the socket of `cliffscan view`, as packet.py and viewer.py describe it."""

import json
import struct

import numpy as np
from websockets.sync.client import connect

DEADLINE = 60.0  # [s]
PROTOCOL = "cliffscan.view.v1"


def opening(port, path="/socket", protocol=PROTOCOL, **options):
    """A context manager: the socket."""
    return connect(f"ws://127.0.0.1:{port}{path}", subprotocols=[protocol], compression=None, max_size=None, **options)


def read(payload):
    """A packet: its header, with its number and its arrays in it."""
    number, length = struct.unpack_from("<II", payload)
    header = json.loads(payload[8 : 8 + length])
    for name, each in header.pop("arrays").items():
        header[name] = np.frombuffer(payload, "<" + each["type"], each["length"], 8 + length + each["at"])
    return header | {"number": number}


class Page:
    """A context manager. Acknowledges what it reads, unless told not to."""

    def __init__(self, port, robot) -> None:
        self._opening = opening(port)
        self._robot = robot

    def __enter__(self):
        self.socket = self._opening.__enter__()
        self.send(watch=self._robot)
        return self

    def __exit__(self, *_):
        self._opening.__exit__(None, None, None)

    def send(self, **message):
        self.socket.send(json.dumps(message))

    def receive(self, timeout=DEADLINE, acknowledge=True):
        packet = read(self.socket.recv(timeout=timeout))
        if acknowledge:
            self.send(ack=packet["number"])
        return packet

    def until(self, holds):
        """The first packet of which `holds` is true."""
        while True:
            packet = self.receive()
            if holds(packet):
                return packet
