"""Eclipse Zenoh, as the services use it; nothing else in the project imports it.

What the settings below are for: a large frame is dropped when one of its fragments waits too long for a full link,
so fragments may wait 0.2 s; the kernel's send buffer is kept small, or small real-time messages queue behind
depth frames in it; a link is given up after 2 s of silence. Shared memory is off: where a process may not lock as
much memory as its peers' pools take (8 MB is a usual limit), Zenoh loses every large message without a word.
"""

from __future__ import annotations

import json
import logging
import threading
from collections.abc import Callable, Collection
from dataclasses import dataclass, field
from pathlib import Path
from types import TracebackType
from typing import Any, Generic, Self, TypeVar

import msgpack
import zenoh

from common.message import Message, MessageError, unpack
from common.topics import Qos, Topic, alive

M = TypeVar("M", bound=Message)
log = logging.getLogger(__name__)

DEFAULTS = {
    "transport/link/tx/lease": 2000,
    "transport/link/tx/queue/congestion_control/drop/wait_before_drop": 50_000,
    "transport/link/tx/queue/congestion_control/drop/max_wait_before_drop_fragments": 200_000,
    "transport/link/tcp/so_sndbuf": 65_536,
    "transport/shared_memory/enabled": False,
}
PRIORITY = {
    Qos.BULK: zenoh.Priority.DATA_LOW,
    Qos.REAL_TIME: zenoh.Priority.REAL_TIME,
    Qos.STATUS: zenoh.Priority.DATA,
}


class BusError(Exception):
    """The network cannot be used as asked; the text is one line that says why."""


class NotConnected(BusError):
    """No endpoint answers yet; it is worth trying again."""


@dataclass(frozen=True)
class Network:
    """Where the other processes are. Endpoints as `tcp/127.0.0.1:7447`; with none, peers on this machine are found."""

    mode: str | None = None  # peer (Zenoh's default), client or router
    connect: list[str] = field(default_factory=list)
    listen: list[str] = field(default_factory=list)
    zenoh_config: Path | None = None

    def settings(self) -> dict[str, object]:
        """Zenoh's settings by key, where this says something."""
        named: dict[str, object] = {
            "mode": self.mode,
            "connect/endpoints": self.connect,
            "listen/endpoints": self.listen,
        }
        if self.connect or (self.listen and self.mode != "router"):  # a router answers whoever looks for one
            named["scouting/multicast/enabled"] = False
        return {key: value for key, value in named.items() if value not in (None, [])}


class Publisher(Generic[M]):
    """Says messages of one topic."""

    def __init__(self, publisher: zenoh.Publisher) -> None:
        self._publisher = publisher

    @property
    def heard(self) -> bool:
        """Whether anybody listens: what nobody hears need not be made."""
        status: Any = self._publisher.matching_status  # a MatchingStatus, whatever zenoh's stubs say
        return bool(status.matching)

    def put(self, message: M) -> None:
        """Send a message; it is dropped where a link is full."""
        self._publisher.put(message.encode())


class Bus:
    """A Zenoh session of one robot. A context manager: leaving it takes every declaration back."""

    def __init__(self, network: Network, robot: str) -> None:
        """Raises NotConnected where a client finds no router, BusError where the settings make no sense."""
        self.robot = robot
        self._session = _open(network)
        self._token: zenoh.LivelinessToken | None = None

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._session.close()  # type: ignore[no-untyped-call]

    def publisher(self, topic: Topic[M]) -> Publisher[M]:
        """Declare that messages of `topic` will be said."""
        return Publisher(
            self._session.declare_publisher(
                topic.key(self.robot),
                encoding=encoding_of(topic),
                congestion_control=zenoh.CongestionControl.DROP,
                priority=PRIORITY[topic.qos],
                express=topic.qos is Qos.REAL_TIME,
            )
        )

    def subscribe(self, path: str, receive: Callable[[str, bytes], object]) -> Callable[[], None]:
        """Call `receive(path, payload)` for every sample on `path` below the robot's name; `*` and `**` are wild.

        The calls come one after another from a thread of the subscription's own, until what is returned is called.
        Raises BusError for what is no path.
        """
        prefix = len(self.robot) + 1

        def deliver(sample: zenoh.Sample) -> None:
            if sample.kind == zenoh.SampleKind.PUT:
                receive(str(sample.key_expr)[prefix:], sample.payload.to_bytes())

        try:
            subscriber = self._session.declare_subscriber(f"{self.robot}/{path}", deliver)
        except zenoh.ZError as error:
            raise BusError(f"{path!r} is no key: {_first_line(error)}") from error
        return subscriber.undeclare

    def answer(
        self, path: str, reply: Callable[[dict[str, Any]], dict[str, Any]], but_at: Collection[str] = ()
    ) -> None:
        """Answer requests at `path` below the robot's name with the map that `reply` makes of their parameters.

        A path with `*` is asked in vain at the paths `but_at`; one without is not asked by a wild card.
        """
        key, others = f"{self.robot}/{path}", {f"{self.robot}/{other}" for other in but_at}

        def deliver(query: zenoh.Query) -> None:
            asked = str(query.key_expr)
            with query:
                if asked in others or ("*" not in path and asked != key):
                    return
                try:
                    parameters = unpack(query.payload.to_bytes()) if query.payload else {}
                except MessageError as error:
                    answered = {"ok": False, "message": f"malformed request: {error}"}
                else:
                    answered = reply(parameters)
                query.reply(query.key_expr, msgpack.packb(answered), encoding=zenoh.Encoding("application/msgpack"))

        self._session.declare_queryable(key, deliver)

    def ask(self, path: str, parameters: dict[str, Any], timeout: float) -> dict[str, Any] | None:
        """The first answer to a request at `path`; None where there was none within `timeout` [s]."""
        replies = self._session.get(f"{self.robot}/{path}", payload=msgpack.packb(parameters), timeout=timeout)
        for reply in replies:
            if reply.ok:
                return unpack(reply.ok.payload.to_bytes())
        return None

    def latch(self, topic: Topic[M]) -> Callable[[M], None]:
        """Declare messages of `topic` that are published once; each is kept for whoever asks later."""
        publisher = self.publisher(topic)
        kept: list[bytes] = []
        lock = threading.Lock()

        def publish(message: M) -> None:
            with lock:
                kept[:] = [message.encode()]
            publisher.put(message)

        def deliver(query: zenoh.Query) -> None:
            with query, lock:
                for payload in kept:
                    query.reply(topic.key(self.robot), payload, encoding=encoding_of(topic))

        self._session.declare_queryable(topic.key(self.robot), deliver)
        return publish

    def receive_latched(self, path: str, receive: Callable[[str, bytes], object]) -> None:
        """Call `receive(path, payload)` for what is kept at `path` now and for what is published there later.

        Whenever a service announces itself the question is put again, so that no start order loses an answer; what is
        kept may come more than once.
        """
        self.subscribe(path, receive)
        key = f"{self.robot}/{path}"

        def answered(reply: zenoh.Reply) -> None:
            if reply.ok:
                receive(path, reply.ok.payload.to_bytes())

        def ask() -> None:
            self._session.get(key, answered, consolidation=zenoh.ConsolidationMode.NONE)

        ask()
        self.watch_alive(lambda _service, here: ask() if here else None)

    def announce(self, service: str) -> None:
        """Tell everyone that `service` works, until withdraw() or the session's end."""
        if not self._token:
            self._token = self._session.liveliness().declare_token(f"{self.robot}/{alive(service)}")

    def withdraw(self) -> None:
        """Tell everyone that the service cannot do its work for now."""
        token, self._token = self._token, None
        if token:
            token.undeclare()  # type: ignore[no-untyped-call]

    def alive(self, timeout: float = 1.0) -> set[str]:
        """The services that work now, by their liveliness tokens."""
        pattern = f"{self.robot}/{alive('*')}"
        replies = self._session.liveliness().get(pattern, timeout=timeout)
        return {str(reply.ok.key_expr).rpartition("/")[2] for reply in replies if reply.ok}

    def robots(self, timeout: float = 1.0) -> dict[str, set[str]]:
        """The services that work now of every robot on the network, by the robot's name."""
        found: dict[str, set[str]] = {}
        middle, end = f"/{alive('')}", alive("*")
        for reply in self._session.liveliness().get(f"**/{end}", timeout=timeout):
            if reply.ok:
                robot, _, service = str(reply.ok.key_expr).rpartition(middle)
                found.setdefault(robot, set()).add(service)
        return found

    def watch_alive(self, changed: Callable[[str, bool], None]) -> None:
        """Call `changed(service, alive)` for every service that works, and whenever that changes."""

        def deliver(sample: zenoh.Sample) -> None:
            changed(str(sample.key_expr).rpartition("/")[2], sample.kind == zenoh.SampleKind.PUT)

        self._session.liveliness().declare_subscriber(f"{self.robot}/{alive('*')}", deliver, history=True)


def encoding_of(topic: Topic[Any]) -> zenoh.Encoding:
    """The Zenoh encoding of a topic's samples, which names their schema."""
    return zenoh.Encoding("application/msgpack").with_schema(topic.message.schema_name())


def _open(network: Network) -> zenoh.Session:
    try:
        config = zenoh.Config.from_file(str(network.zenoh_config)) if network.zenoh_config else zenoh.Config()
        for key, value in ((DEFAULTS if not network.zenoh_config else {}) | network.settings()).items():
            config.insert_json5(key, json.dumps(value))
    except zenoh.ZError as error:
        raise BusError(f"Zenoh refuses the configuration: {_first_line(error)}") from error
    try:
        return zenoh.open(config)
    except zenoh.ZError as error:
        reason = _first_line(error)
        raise (NotConnected if "Unable to connect" in reason else BusError)(reason) from error


def _first_line(error: Exception) -> str:
    """Zenoh's reason without the place in its source."""
    return str(error).split(" at /")[0].splitlines()[0].strip()
