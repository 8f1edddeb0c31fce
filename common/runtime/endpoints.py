"""Zenoh's endpoints, as `tcp/127.0.0.1:7447`: who can reach them, and whether they ask for keys."""

from typing import NamedTuple

NETWORKED = ("tcp", "udp", "tls", "quic", "ws")  # the other protocols stay on one machine, or are a cable
KEYED = ("tls", "quic")
LAST_PORT = 65_535
LOCAL_NAMES = ("localhost", "::1")


class Endpoint(NamedTuple):
    """The parts of an endpoint; port 0 where it names none."""

    protocol: str
    host: str
    port: int

    @property
    def beyond(self) -> bool:
        """Whether other machines can reach it."""
        local = self.host in LOCAL_NAMES or self.host.startswith("127.")
        return self.protocol in NETWORKED and not local

    @property
    def nameless(self) -> bool:
        """Whether it lacks the host that its protocol needs."""
        return self.protocol in NETWORKED and not self.host

    @property
    def portless(self) -> bool:
        """Whether it lacks the port that its protocol needs to connect."""
        return self.protocol in NETWORKED and not self.port

    @property
    def keyed(self) -> bool:
        """Whether what passes is encrypted, and either side may ask for keys."""
        return self.protocol in KEYED


def parse(text: str) -> Endpoint:
    """The parts of an endpoint's text; Zenoh says what is wrong with it."""
    protocol, _, address = text.partition("#")[0].partition("?")[0].partition("/")
    host, colon, port = address.rpartition(":")
    if protocol in NETWORKED and (not colon or address.endswith("]")):  # it names no port
        host, port = address, ""
    return Endpoint(protocol, host.strip("[]"), int(port) if port.isdecimal() else 0)
