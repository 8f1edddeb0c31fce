"""The life of a service: configuration, signals, the bus, the ready token, status every second, a clean end."""

import argparse
import logging
import math
import os
import sys
import threading
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Generic, TypeVar

from cliffscan.common.contract.limits import LONGEST_TEXT
from cliffscan.common.contract.message import Message, MessageError
from cliffscan.common.contract.messages import ServiceStatus, State
from cliffscan.common.contract.topics import STATUS, Topic
from cliffscan.common.runtime import config as configuration
from cliffscan.common.runtime import options
from cliffscan.common.runtime.alive_file import mark_alive
from cliffscan.common.runtime.bus import Bus, Publisher
from cliffscan.common.runtime.config import ConfigError, ServiceConfig
from cliffscan.common.runtime.decoder import Decoder
from cliffscan.common.runtime.kept_memory import keep_freed_memory
from cliffscan.common.runtime.latest_queue import LatestQueue
from cliffscan.common.runtime.metrics import ServiceMetrics
from cliffscan.common.runtime.network import BusError, Network, NotConnected
from cliffscan.common.runtime.stop_signal import StopSignal

C = TypeVar("C", bound=ServiceConfig)
M = TypeVar("M", bound=Message)

ROOM = 8  # messages that may wait to be unpacked
RATE = 200.0  # [Hz] at which messages of a topic are unpacked
PATIENCE = 0.1  # [s] a wait may last before the service looks whether it should end
STATUS_PERIOD = 1.0  # [s] between two statuses
RETRY = 0.5  # [s] between two attempts to reach a router
USAGE_ERROR = 2

log = logging.getLogger(__name__)


class Service(Generic[C]):
    """What a service's own code works with: its configuration, the bus, and whether to go on."""

    def __init__(self, name: str, config: C, bus: Bus, stop: StopSignal) -> None:
        self.name = name
        self.config = config
        self.bus = bus
        self.metrics = ServiceMetrics()
        self.note = ""
        self.state: State = "starting"
        self._stop = stop
        mark_alive(False)  # one of a process that was killed
        self._status_publisher = bus.publisher(STATUS.named(name))
        self._born = self._told = time.monotonic()

    @property
    def running(self) -> bool:
        """False once the service was asked to end."""
        return not self._stop.is_set()

    def pause(self, seconds: float) -> None:
        """Wait, but not beyond the service's end."""
        self._stop.wait(seconds)

    def publisher(self, topic: Topic[M]) -> Publisher[M]:
        """Declare that messages of `topic` will be published."""
        return self.bus.publisher(topic)

    def receive(self, topic: Topic[M], accept: Callable[[M], None], room: int = ROOM) -> None:
        """Call `accept`, from a thread of the topic's own, for every good message; bad ones are counted and logged.

        No more than RATE are looked at; of others that come meanwhile the newest `room` are kept.
        """
        decoder = Decoder(topic.message, self.metrics)

        def arrived(path: str, payload: bytes) -> None:
            message = decoder.decode(path, payload)
            if message is not None:
                accept(message)

        self.bus.subscribe(topic.path, arrived, room, RATE, decoder.refused)

    def receive_latched(self, topic: Topic[M], accept: Callable[[M], None]) -> None:
        """Call `accept`, from several threads, for every good message that is kept or published; see the bus."""

        def arrived(path: str, payload: bytes) -> None:
            try:
                message = topic.message.decode(payload)
            except MessageError as error:
                self.metrics.warn_limited("malformed", f"{path}: {error}")
                return
            accept(message)

        self.bus.receive_latched(topic.path, arrived)

    def newest(self, topic: Topic[M]) -> Iterator[M]:
        """Every good message of `topic` until the service ends; while one is worked on, only the newest is kept."""
        queue: LatestQueue[M] = LatestQueue()

        def accept(message: M) -> None:
            if not queue.put(message):
                self.metrics.count("overtaken")

        self.receive(topic, accept, room=2)
        self.ready()
        while self.running:
            message = queue.get(PATIENCE)
            if message is not None:
                yield message

    def ready(self) -> None:
        """Announce that the service can do its work; again, after it had to wait for a device."""
        self._stop.patient = True
        self.announce()
        log.info("ready, version %s", package_version())

    def announce(self) -> None:
        """Hold the liveliness token."""
        self.state, self.note = "working", ""
        self.bus.announce(self.name)
        mark_alive(True)

    def waiting(self, note: str) -> None:
        """The service cannot do its work, because of a device, say: withdraw the token until ready() again."""
        self.state, self.note = "waiting", note
        mark_alive(False)
        self.bus.withdraw()

    def publish_status(self) -> None:
        """Publish how the service fares; its rate is that since the last time."""
        now = time.monotonic()
        self._status_publisher.put(self._status(self.metrics.take_outputs() / (now - self._told), now - self._born))
        self._told = now

    def _status(self, rate: float, uptime: float) -> ServiceStatus:
        return ServiceStatus(
            stamp=time.time_ns(),
            service=self.name,
            version=package_version(),
            state=self.state,
            pid=os.getpid(),
            uptime=uptime,
            rate=rate,
            latency=self.metrics.latency(),
            counts=self.metrics.counts(),
            note="; ".join(filter(None, (self.note, self.bus.notice())))[:LONGEST_TEXT],
        )


@cache  # each look-up reads files, and the status has it every second
def package_version() -> str:
    """The installed version, or `source` when run from a plain checkout."""
    try:
        return version("cliffscan")
    except PackageNotFoundError:
        return "source"


def main(name: str, kind: type[C], serve: Callable[[Service[C]], None]) -> None:
    """Run a service from the command line until it ends or is asked to; leaves with the process's exit code."""

    def work(arguments: argparse.Namespace, configs: Mapping[str, C]) -> None:
        run(name, configs[name], options.network(arguments), arguments.robot, serve)

    execute(
        name,
        options.add_robot,
        lambda file, overrides: {name: configuration.load(name, kind, file, overrides)},
        work,
    )


def execute(
    name: str,
    add_robot: options.Adder,
    load: Callable[[Path | None, Sequence[str]], Mapping[str, C]],
    work: Callable[[argparse.Namespace, Mapping[str, C]], None],
) -> None:
    """Be the process `name`: read the command line and the configuration of its services, work, leave.

    load: as configuration.load, of all services in it by name.
    """
    parser = argparse.ArgumentParser(prog=f"cliffscan run {name}", description=sys.modules["__main__"].__doc__)
    options.add_network(parser, add_robot)
    parser.set_defaults(role=name)
    options.add_config(parser)
    options.add_dump_config(parser)
    arguments = parser.parse_args()
    try:
        configs = load(arguments.config, arguments.set)
    except ConfigError as error:
        parser.exit(USAGE_ERROR, f"{name}: {error}\n")
    if arguments.dump_config:
        sys.stdout.write(configuration.dump(configs))
        parser.exit(0)
    logging.basicConfig(level=logging.INFO, format=f"%(asctime)s %(levelname)s {name}: %(message)s")
    keep_freed_memory()
    try:
        for config in configs.values():
            config.check()
        work(arguments, configs)
    except (BusError, ConfigError) as error:
        parser.exit(USAGE_ERROR, f"{name}: {error}\n")
    logging.shutdown()
    os._exit(0)  # all is published and closed; to take the compiler apart would cost another half a second


def run(name: str, config: C, network: Network, robot: str, serve: Callable[[Service[C]], None]) -> None:
    """Serve until SIGTERM or Ctrl-C. Raises BusError where the network cannot be used as asked."""

    def work(bus: Bus, stop: StopSignal) -> None:
        service = Service(name, config, bus, stop)
        with reporting(service.publish_status, stop):
            if service.running:
                serve(service)
        log.info("ended: %s", service.metrics.counts())

    on_bus(network, robot, work)


def on_bus(network: Network, robot: str, work: Callable[[Bus, StopSignal], None]) -> None:
    """Do `work` on the bus as soon as there is one, until SIGTERM or Ctrl-C. Raises BusError as Bus does."""
    stop = StopSignal()
    bus = connect(network, robot, stop)
    if bus is not None:
        with bus:
            work(bus, stop)


@contextmanager
def reporting(report: Callable[[], None], stop: StopSignal) -> Iterator[None]:
    """Call `report` once a second meanwhile; until ready() a signal ends the process at once."""

    def repeat() -> None:
        while not stop.wait(STATUS_PERIOD):
            report()

    reporter = threading.Thread(target=repeat, name="status")
    reporter.start()
    try:
        stop.patient = False
        yield
    finally:
        stop.patient = True
        stop.set()
        reporter.join()


def connect(network: Network, robot: str, stop: StopSignal, seconds: float = math.inf) -> Bus | None:
    """The bus, as soon as a router answers; None where none did in `seconds` [s] or the process was asked to end."""
    told, until = "", time.monotonic() + seconds
    while not stop.is_set() and time.monotonic() < until:
        try:
            bus = Bus(network, robot)
        except NotConnected as error:
            if str(error) != told:
                log.info("waiting for a router: %s", error)
                told = str(error)
            stop.wait(RETRY)
        else:
            bus.watch_door()
            return bus
    return None
