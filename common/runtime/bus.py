"""Eclipse Zenoh, as the services use it; beside this only neighbours in this folder import it."""

import logging
import threading
import time
from collections.abc import Callable, Collection, Iterator
from copy import copy
from typing import Any, Generic, Self, TypeVar

import msgpack
import zenoh

from cliffscan.common.contract.limits import SMALL
from cliffscan.common.contract.message import Message, MessageError, check_size, unpack
from cliffscan.common.contract.topics import ROBOT_NAME, Topic, alive, most_bytes
from cliffscan.common.runtime.foreign_keys import ForeignKeys
from cliffscan.common.runtime.metrics import ServiceMetrics
from cliffscan.common.runtime.network import BusError, Network, first_line, linked, linked_twice, open_session
from cliffscan.common.runtime.pace import Pace
from cliffscan.common.runtime.qos import declare_publisher
from cliffscan.common.runtime.raw_samples import RawSamples
from cliffscan.common.runtime.reader import Readers

M = TypeVar("M", bound=Message)
log = logging.getLogger(__name__)

ROOM = 256  # samples that may wait for a program that must not miss any
TOKENS = 16_384  # news of tokens that may wait: of a state none may be missed, and there are as many as tokens change
REQUESTS = 8  # that may wait at a path
RATE = 200.0  # [Hz] at which the requests at a path are answered
AGAIN = 0.05  # [s] after which a question that found nothing is put again
FLEET = "fleet"  # beginning of the keys of groups, which are no robot's
EVERY = "**"  # robot, where a name may have several parts
LATCH_TIMEOUT = 1.0  # [s] for what is kept to come
LATCH_TRIES = 10  # for it where who keeps it is too busy to answer


class Publisher(Generic[M]):
    """Publishes messages of one topic."""

    def __init__(self, publisher: zenoh.Publisher) -> None:
        self._publisher = publisher

    @property
    def has_subscribers(self) -> bool:
        """Whether anybody subscribes: what nobody receives need not be made."""
        status: Any = self._publisher.matching_status  # a MatchingStatus, whatever zenoh's stubs say
        return bool(status.matching)

    def put(self, message: M) -> None:
        """Send a message; it is dropped where a link is full."""
        self._publisher.put(message.encode())


class Bus:
    """A Zenoh session of one robot. A context manager: leaving it takes every declaration back."""

    def __init__(self, network: Network, robot: str) -> None:
        """Raises NotConnected where a client finds no router, BusError where the settings make no sense."""
        self._session, self._door = open_session(network, robot)
        self._readers = Readers()
        self._metrics = ServiceMetrics()
        self._begin(robot)

    def _begin(self, robot: str) -> None:
        self.robot = robot
        self._token: zenoh.LivelinessToken | None = None
        self._declared: list[Any] = []

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._door.close()
        self._session.close()  # type: ignore[no-untyped-call]
        self._readers.join()

    @property
    def connected(self) -> bool:
        """Whether a router or another peer is reached at this moment."""
        return linked(self._session)

    @property
    def joined(self) -> bool:
        """Whether this router and another of ours are joined at this moment, which is by two links."""
        return linked_twice(self._session)

    def watch_door(self) -> None:
        """Log why nothing passes, as long as nothing does; until the session ends."""
        self._readers.once("door", self._door.watch)

    def notice(self) -> str:
        """What a person should know of this process's keys and its links; empty where there is nothing."""
        return self._door.notice()

    def beside(self, robot: str) -> Self:
        """The keys of a robot in the same session, with a token of their own; retract() takes them back."""
        other = copy(self)
        other._begin(robot)
        return other

    def ros_keys(self, domain: int) -> ForeignKeys:
        """Keys of a domain of ROS 2 in the same session; retract() leaves them."""
        self._door.check_ros_domain(domain)
        return ForeignKeys(self._session, self._readers)

    def raw_samples(self) -> RawSamples:
        """The robot's samples as they are, neither decoded nor checked; retract() leaves them."""
        return RawSamples(self._session, self._readers, self.robot)

    def retract(self) -> None:
        """Take back all that was declared here; what others declared in the session stays."""
        self.withdraw()
        while self._declared:
            self._declared.pop().undeclare()

    def publisher(self, topic: Topic[M]) -> Publisher[M]:
        """Declare that messages of `topic` will be published."""
        self._door.check_publishes(topic.path)
        publisher = declare_publisher(self._session, topic.key(self.robot), encoding_of(topic), topic.qos)
        self._declared.append(publisher)
        return Publisher(publisher)

    def subscribe(
        self,
        path: str,
        receive: Callable[[str, bytes], object],
        room: int = ROOM,
        rate: float | None = None,
        refused: Callable[[str, MessageError], object] | None = None,
    ) -> Callable[[], None]:
        """Call `receive(path, payload)` for every sample on `path` below the robot's name; `*` and `**` are wild.

        The calls come one after another from a thread of the subscription's own, at most `rate` [Hz] where that is
        given, until what is returned is called. `room` samples may wait; beyond, the oldest is dropped, uncounted. A
        payload larger than its key allows is not even copied, and `refused(path, why)` is called. Raises BusError for
        what is no path.
        """
        self._door.check_receives(path)
        prefix = len(self.robot) + 1
        refuse = refused or self._refused

        def deliver(key: str, sample: zenoh.Sample) -> None:
            at = key[prefix:]
            try:
                payload = _bytes(sample.payload, most_bytes(at))
            except MessageError as error:
                refuse(at, error)
            else:
                receive(at, payload)

        return self._subscribe(f"{self.robot}/{path}", deliver, room, Pace(rate, room) if rate else None)

    def subscribe_robots(
        self,
        path: str,
        receive: Callable[[str, bytes], object],
        room: int,
        wanted: Callable[[str], bool],
        refused: Callable[[str, MessageError], object],
        of_others: bool = False,
    ) -> None:
        """Call `receive(robot, payload)` for the samples on `path` of each robot whose sample is `wanted(robot)`.

        The bus's own robot may be EVERY. What is not wanted is not copied. of_others: not what this session published.
        Otherwise as subscribe().
        """
        suffix = len(path) + 1

        def deliver(key: str, sample: zenoh.Sample) -> None:
            robot = key[:-suffix]
            if not ROBOT_NAME.fullmatch(robot) or not wanted(robot):
                return
            try:
                payload = _bytes(sample.payload, most_bytes(path))
            except MessageError as error:
                refused(robot, error)
            else:
                receive(robot, payload)

        self._subscribe(f"{self.robot}/{path}", deliver, room, None, of_others)

    def _subscribe(
        self,
        key: str,
        deliver: Callable[[str, zenoh.Sample], None],
        room: int,
        pace: Pace | None,
        of_others: bool = False,
    ) -> Callable[[], None]:
        """Call `deliver(key, sample)` for every sample that was put, until what is returned is called."""
        origin = zenoh.Locality.REMOTE if of_others else zenoh.Locality.ANY
        ended = threading.Event()
        only = None if "*" in key else key  # to ask each sample for its key costs as much as to unpack a small one

        def take(sample: zenoh.Sample) -> None:
            if sample.kind == zenoh.SampleKind.PUT and not ended.is_set():
                deliver(only or str(sample.key_expr), sample)

        try:
            source = self._session.declare_subscriber(key, zenoh.handlers.RingChannel(room), allowed_origin=origin)
        except zenoh.ZError as error:
            path = key.removeprefix(f"{self.robot}/")
            raise BusError(f"{path!r} is no key: {first_line(error)}") from error
        self._declared.append(source)
        self._readers.read(source, take, pace)
        return ended.set

    def answer(
        self, path: str, reply: Callable[[dict[str, Any]], dict[str, Any]], except_paths: Collection[str] = ()
    ) -> None:
        """Answer requests at `path` below the robot's name with the map that `reply` makes of their parameters.

        A path with `*` does not answer at `except_paths`; one without does not answer a wild card. Requests beyond
        RATE wait; where too many do, the oldest gets no answer.
        """
        key, others = f"{self.robot}/{path}", {f"{self.robot}/{other}" for other in except_paths}

        def deliver(query: zenoh.Query) -> None:
            asked = str(query.key_expr)
            if asked in others or ("*" not in path and asked != key):
                return
            try:
                parameters = unpack(_bytes(query.payload, SMALL)) if query.payload else {}
            except MessageError as error:
                answered = {"ok": False, "message": f"malformed request: {error}"}
            else:
                answered = reply(parameters)
            query.reply(query.key_expr, msgpack.packb(answered), encoding=zenoh.Encoding("application/msgpack"))

        self._queries(key, deliver)

    def ask(self, path: str, parameters: dict[str, Any], timeout: float) -> dict[str, Any] | None:
        """The first answer to a request at `path`; None where there was none within `timeout` [s]."""
        replies = self._session.get(f"{self.robot}/{path}", payload=msgpack.packb(parameters), timeout=timeout)
        for reply in replies:
            if reply.ok:
                return unpack(_bytes(reply.ok.payload, SMALL))
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
            with lock:
                for payload in kept:
                    query.reply(topic.key(self.robot), payload, encoding=encoding_of(topic))

        self._queries(topic.key(self.robot), deliver)
        return publish

    def receive_latched(self, path: str, receive: Callable[[str, bytes], object]) -> None:
        """Call `receive(path, payload)` for what is kept at `path` now and for what is published there later.

        Whenever a service announces itself the question is put again, so that no start order loses an answer; what is
        kept may come more than once, and from several threads.
        """
        self.subscribe(path, receive)
        key = f"{self.robot}/{path}"

        def ask() -> None:
            for _ in range(LATCH_TRIES):
                began = time.monotonic()
                replies = list(self._replies(key))
                for payload in replies:
                    try:
                        receive(path, _bytes(payload, most_bytes(path)))
                    except MessageError as error:
                        self._refused(path, error)
                if replies or time.monotonic() - began < LATCH_TIMEOUT:  # else somebody keeps it, and was too busy
                    return

        self.watch_alive(lambda _service, here: ask() if here else None)
        self._readers.once(key, ask)

    def _replies(self, key: str) -> Iterator[zenoh.ZBytes]:
        """What is kept at a key; not through a ring, which drops what it holds with the end of the answers."""
        every = zenoh.ConsolidationMode.NONE
        for reply in self._session.get(key, consolidation=every, timeout=LATCH_TIMEOUT):
            if reply.ok:
                yield reply.ok.payload

    def announce(self, service: str) -> None:
        """Announce that `service` works, until withdraw() or the session's end."""
        if not self._token:
            self._token = self._session.liveliness().declare_token(f"{self.robot}/{alive(service)}")

    def withdraw(self) -> None:
        """Withdraw the announcement: the service cannot do its work for now."""
        token, self._token = self._token, None
        if token:
            token.undeclare()  # type: ignore[no-untyped-call]

    def alive(self, timeout: float = 1.0) -> set[str]:
        """The services that work now, by their liveliness tokens."""
        return {key.rpartition("/")[2] for key in self._tokens(f"{self.robot}/{alive('*')}", timeout)}

    def routers(self, timeout: float = 1.0) -> set[str]:
        """The keys of the tokens of all routers that are there, of whatever robot."""
        return set(self._tokens(f"**/{alive('router-$*')}", timeout))

    def robots(self, timeout: float = 1.0) -> dict[str, set[str]]:
        """The services that work now of every robot on the network, by the robot's name.

        A busy router may answer that it knows of none before it does; so none is believed after `timeout` [s] only.
        """
        found: dict[str, set[str]] = {}
        middle, end = f"/{alive('')}", alive("*")
        deadline = time.monotonic() + timeout
        while not found and (left := deadline - time.monotonic()) > 0.0:
            for key in self._tokens(f"**/{end}", left):
                robot, _, service = key.rpartition(middle)
                found.setdefault(robot, set()).add(service)
            if not found:
                time.sleep(AGAIN)
        return found

    def _tokens(self, pattern: str, timeout: float) -> Iterator[str]:
        """The keys of the tokens on a pattern.

        A session that watches them answers by itself before the question returns, so all must have room. And Zenoh may
        tell its watchers once more of a token that has just gone: who watches tokens that matter asks by another one.
        """
        room: zenoh.handlers.FifoChannel[zenoh.Reply] = zenoh.handlers.FifoChannel(TOKENS)
        replies = self._session.liveliness().get(pattern, room, timeout=timeout)
        return (str(reply.ok.key_expr) for reply in replies if reply.ok)

    def watch_alive(self, changed: Callable[[str, bool], None]) -> None:
        """Call `changed(service, alive)` for every service that works, and whenever that changes."""
        self._watch(f"{self.robot}/{alive('*')}", lambda key, here: changed(key.rpartition("/")[2], here))

    def watch_robots(self, changed: Callable[[str, str, bool], None]) -> None:
        """Call `changed(robot, service, alive)` as watch_alive(), from two threads; the bus's own robot may be EVERY.

        Of one of several processes that would be a service, the service is `service/name`.
        """
        middle = f"/{alive('')}"

        def split(key: str, here: bool) -> None:
            robot, _, service = key.rpartition(middle)
            changed(robot, service, here)

        for service in ("*", "*/*"):
            self._watch(f"{self.robot}/{alive(service)}", split)

    def join(self, group: str, name: str) -> None:
        """Be a member of a group of processes, which belongs to no robot, until the session's end."""
        self._declared.append(self._session.liveliness().declare_token(f"{FLEET}/{group}/{name}"))

    def watch_members(self, group: str, changed: Callable[[str, bool], None]) -> None:
        """Call `changed(name, here)` for every member of a group, this process too, and whenever that changes."""
        self._watch(f"{FLEET}/{group}/*", lambda key, here: changed(key.rpartition("/")[2], here))

    def _watch(self, pattern: str, changed: Callable[[str, bool], None]) -> None:
        """Call `changed(key, here)` for the liveliness tokens on a pattern, those of now and whenever one changes."""

        def deliver(sample: zenoh.Sample) -> None:
            changed(str(sample.key_expr), sample.kind == zenoh.SampleKind.PUT)

        ring: zenoh.handlers.RingChannel[zenoh.Sample] = zenoh.handlers.RingChannel(TOKENS)
        source = self._session.liveliness().declare_subscriber(pattern, ring, history=True)
        self._declared.append(source)
        self._readers.read(source, deliver)

    def _queries(self, key: str, deliver: Callable[[zenoh.Query], None]) -> None:
        """Call `deliver` for the requests at a key; each ends for its asker when it returns."""

        def take(query: zenoh.Query) -> None:
            with query:
                deliver(query)

        source = self._session.declare_queryable(key, zenoh.handlers.RingChannel(REQUESTS))
        self._declared.append(source)
        self._readers.read(source, take, Pace(RATE, REQUESTS))

    def _refused(self, path: str, why: MessageError) -> None:
        self._metrics.warn_limited("malformed", f"{path}: {why}")


def _bytes(payload: zenoh.ZBytes, most: int) -> bytes:
    """A payload, copied only where it has no more than `most` bytes. Raises MessageError."""
    check_size(len(payload), most)
    return payload.to_bytes()


def encoding_of(topic: Topic[Any]) -> zenoh.Encoding:
    """The Zenoh encoding of a topic's samples, which names their schema."""
    return zenoh.Encoding("application/msgpack").with_schema(topic.message.schema_name())
