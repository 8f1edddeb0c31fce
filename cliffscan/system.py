"""The whole system on one machine: a router, and the services that speak through it."""

import logging
import re
import sys
from collections.abc import Mapping, Sequence
from contextlib import ExitStack
from dataclasses import dataclass, field, replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Self

from cliffscan import preflight
from cliffscan.common.contract.roles import ROUTER, WORKSTATION_ROUTER
from cliffscan.common.runtime import config as configuration
from cliffscan.common.runtime.bus import Bus
from cliffscan.common.runtime.config import SENSING, TABLES, ConfigError, meant_for
from cliffscan.common.runtime.network import Network, NotConnected, targets
from cliffscan.common.runtime.options import VIEWER
from cliffscan.common.runtime.secure import Credentials
from cliffscan.common.runtime.stop_signal import StopSignal
from cliffscan.common.runtime.suggest import suggest
from cliffscan.hang_up import hang_up_stops
from cliffscan.parts import KOBUKI, NO_BASE, PERCEPTION, REAL, SCANS, WORKSTATION, Part, listening, services_of
from cliffscan.plain import plain
from cliffscan.run import command_line
from cliffscan.services.capture.config import CaptureConfig
from cliffscan.services.capture.sources.kinds import KINDS
from cliffscan.supervisor import Supervisor

ANYWHERE = re.compile(r"/(0\.0\.0\.0|\[::\]):")
SIMULATION = "simulation"
LAST = "capture"  # started when all others are ready, so that its first frame is not lost
TURN = 0.1  # [s] between two looks at the processes

log = logging.getLogger("cliffscan")


@dataclass(frozen=True)
class Plan:
    """What to start: the robot's name, its router's endpoints and the routers it joins, the configuration, the base.

    part: of a robot whose services are spread over two hosts; None where all are on this one. base: REAL, which is a
    Kobuki, NO_BASE, or the service that drives it.

    With a world, a simulation of the robot in it is both base and camera; what goes between processes without the
    network is in `folder`. Without, the camera must be named in the configuration.
    """

    robot: str = "turtlebot"
    listen: Sequence[str] = (listening(None, secure=False),)
    join: Sequence[str] = ()
    config: Path | None = None
    overrides: Sequence[str] = field(default_factory=list)  # SERVICE.KEY=VALUE
    base: str = NO_BASE  # beside the one of a world
    world: str = ""
    simulation: Sequence[str] = ()  # further options of the simulation
    folder: str = ""
    secure: Path | None = None  # the folder of keys, of which each process uses its own
    insecure: bool = False  # others may connect without keys
    part: Part | None = None
    perception: bool = False  # one process for all scans; of a robot's part, which has none otherwise

    @property
    def endpoint(self) -> str:
        """Where the router is reached from this machine."""
        return ANYWHERE.sub("/127.0.0.1:", self.listen[0])

    def router(self) -> list[str]:
        """The router's command line."""
        ends = [("--listen", end) for end in self.listen] + [("--connect", end) for end in self.join]
        words = [word for option in ends for word in option]
        words += ["--name", self.part] if self.part else []
        words += [*self._keys(), "--role", self.router_role] if self.secure else ["--insecure"] if self.insecure else []
        return [sys.executable, "-m", "cliffscan", "router", "--robot", self.robot, *words]

    @property
    def router_role(self) -> str:
        """Whose keys the router uses."""
        return WORKSTATION_ROUTER if self.part == WORKSTATION else ROUTER

    def service(self, name: str) -> list[str]:
        """A service's command line, with the overrides that are its own."""
        words = ["--robot", self.robot, "--mode", "client", "--connect", self.endpoint, *self._keys()]
        words += ["--config", str(self.config)] if self.config else []
        words += [word for override in self.own(name) for word in ("--set", override)]
        return command_line(name, words)

    def client(self, role: str) -> Network:
        """How a process is connected that has the keys of a role, where there are keys."""
        return Network("client", [self.endpoint], secure=self._credentials(role))

    def router_network(self) -> Network:
        """How the router is connected."""
        keys = self._credentials(self.router_role)
        return Network("router", [*self.join], [*self.listen], secure=keys, insecure=self.insecure)

    def _credentials(self, role: str) -> Credentials | None:
        return Credentials(self.secure, role, [self.robot]) if self.secure else None

    def _keys(self) -> list[str]:
        return ["--secure", str(self.secure)] if self.secure else []

    def capture(self) -> list[str]:
        """Capture's command line."""
        return [*self.service("capture"), *(word for each in self._simulated_camera() for word in ("--set", each))]

    def camera(self) -> CaptureConfig:
        """Capture's configuration. Raises ConfigError."""
        overrides = [*self.own("capture"), *self._simulated_camera()]
        return configuration.load("capture", CaptureConfig, self.config, overrides)

    @property
    def services(self) -> list[str]:
        """The services that are started, in the order in which frames pass through them."""
        return [*services_of(self.part, self.perception), *([self.base_service] if self.base_service else [])]

    @property
    def base_service(self) -> str:
        """The service of the base that is started; empty for none."""
        if self.world or self.base == REAL:
            return KOBUKI
        return "" if self.base == NO_BASE else self.base

    @property
    def configured(self) -> list[str]:
        """The services whose settings are read here, by the names of their tables."""
        if not self.part:
            return [*SENSING, self.base_service or KOBUKI]
        return [name for service in self.services for name in tables_of(service)]

    @property
    def port(self) -> Path | None:
        """The port of a base that is started too."""
        return Path(self.folder) / "kobuki" if self.world else None

    def base_processes(self) -> dict[str, list[str]]:
        """The command lines of the base's processes by name, the base itself first."""
        if self.world:
            ends = ["--link", str(self.port), "--control", f"{self.folder}/control"]
            simulation = [sys.executable, "-m", "cliffscan.simulator", *self._simulation(), *ends]
            return {SIMULATION: simulation, KOBUKI: [*self.service(KOBUKI), "--set", f"kobuki.port={self.port}"]}
        return {self.base_service: self.service(self.base_service)} if self.base_service else {}

    def _simulated_camera(self) -> list[str]:
        """What makes capture the camera of the simulated robot."""
        return ["capture.source=simulator", f"capture.simulation={self.folder}/frames"] if self.world else []

    def _simulation(self) -> list[str]:
        """The simulation's options: its camera is capture's. Raises ConfigError."""
        camera = self.camera()
        mount = ["--height", camera.height, "--pitch", camera.pitch, "--roll", camera.roll]
        ends = ["--world", self.world, "--frames", f"{self.folder}/frames", "--sensor", camera.sensor]
        return [*ends, *map(str, mount), "--rate", str(camera.rate), "--seed", str(camera.seed), *self.simulation]

    def own(self, service: str) -> list[str]:
        """The overrides that are meant for a service."""
        tables = tables_of(service)
        return [override for override in self.overrides if any(meant_for(table, override) for table in tables)]

    def dump(self) -> str:
        """All services' configuration as TOML; with the same base and world, --config takes it. Raises ConfigError.

        The address of a simulation is not in it, for each start makes a new one.
        """
        world = ["capture.source=simulator", f"capture.world={self.world}"] if self.world else []
        plan = replace(self, overrides=[*self.overrides, *world])
        configs = {
            service: preflight.load_config(service, plan.config, plan.own(service)) for service in self.configured
        }
        return configuration.dump(configs)

    def check(self) -> None:
        """Raise ConfigError for what a process would refuse, or must not be together, before any is started."""
        preflight.check_networks([self.router_network(), *map(self.client, (*self.services, VIEWER))])
        self._check_join()
        for override in self.overrides:
            self._check_override(override)
        if "capture" in self.services:
            given = configuration.given("capture", CaptureConfig, self.config, self.own("capture"))
            if self.world:
                self._check_world(given)
            else:
                self._check_camera(given.get("source"))
        for service in self.configured:
            simulated = self._simulated_camera() if service == "capture" else []
            preflight.load_config(service, self.config, [*self.own(service), *simulated])

    def _check_join(self) -> None:
        """The workstation's part must know where the robot is. Raises ConfigError."""
        if self.part == WORKSTATION and not targets(self.router_network()):
            keys = f"make keys with --host ROBOT ({self.secure} names none), or " if self.secure else ""
            protocol = "tls" if self.secure else "tcp"
            raise ConfigError(f"--part workstation: where is the robot? {keys}add --connect {protocol}/ROBOT:7447")

    def _check_override(self, override: str) -> None:
        """An override must be meant for a service that is configured here. Raises ConfigError."""
        if any(meant_for(service, override) for service in self.configured):
            return
        table = override.partition(".")[0]
        if self.part and table in TABLES:
            started = ", ".join(self.services)
            raise ConfigError(f"--set {override}: {table} is not of --part {self.part} ({started}); leave it out here")
        expected, meant = ", ".join(TABLES), suggest(table, TABLES)
        raise ConfigError(f"--set {override}: expected TABLE.KEY=VALUE, TABLE one of {expected}{meant}")

    def _check_world(self, given: Mapping[str, object]) -> None:
        """A simulated robot has a camera and a base of its own. given: of capture. Raises ConfigError."""
        if self.base != NO_BASE:
            raise ConfigError(f"a simulated world has no place for a {self.base} base: leave out the one or the other")
        preflight.check_world(self.world)
        if given.get("source", "simulator") != "simulator":
            raise ConfigError(
                f"capture.source={given['source']} shows another place than the simulated robot's world {self.world}:"
                " add --base real, or --base none"
            )
        if given.get("world", self.world) != self.world:
            raise ConfigError(f"capture.world={given['world']}: the robot is in {self.world}; --world NAME chooses it")
        if given.get("simulation"):
            raise ConfigError(f"capture.simulation={given['simulation']}: it is another simulation's; add --base none")
        port = next((each for each in self.overrides if each.startswith("kobuki.port=")), None)
        if port:
            raise ConfigError(f"--set {port}: the simulated robot has a base of its own; add --base real for this one")

    def _check_camera(self, source: str | None) -> None:
        """A camera must be named, and a real base must not follow pictures of elsewhere. Raises ConfigError."""
        if source is None:
            others = "" if self.base != NO_BASE else ", or replay with capture.path=DIR, or simulator"
            raise ConfigError(f"no camera is named: add --set capture.source=kinect{others}")
        if self.base != NO_BASE and source in KINDS and KINDS[source].simulated:
            raise ConfigError(
                f"capture.source={source} does not show where a real base drives: add --set capture.source=kinect,"
                f" or leave out --base {self.base}"
            )


def tables_of(service: str) -> Sequence[str]:
    """The tables of a service's own that it reads: perception those of the three that it is."""
    return SCANS if service == PERCEPTION else (service,)


class System:
    """A context manager: entering starts the router and the services, leaving ends them all.

    poll() is to be called a few times a second; it starts capture when the others are ready, the base's service when
    its port is there, and what ended again.
    """

    bus: Bus

    def __init__(self, plan: Plan, stop: StopSignal) -> None:
        plan.check()
        for end in plan.listen:
            preflight.check_free(end)
        self.alive: set[str] = set()
        self.supervisor = Supervisor()
        self.plan = plan
        self._stop = stop
        self._exit = ExitStack()

    def __enter__(self) -> Self:
        with ExitStack() as entered:
            entered.enter_context(hang_up_stops(self._stop))
            folder = entered.enter_context(TemporaryDirectory(prefix="cliffscan-", ignore_cleanup_errors=True))
            self.plan = replace(self.plan, folder=folder)
            entered.enter_context(self.supervisor)
            self.supervisor.start("router", self.plan.router(), ground=True)
            self.bus = entered.enter_context(self._connect())
            self.bus.watch_alive(self.changed)
            for name in self._first():
                self.supervisor.start(name, self.plan.service(name))
            self._base = self.plan.base_processes()
            self._start_base()
            self._exit = entered.pop_all()
        return self

    def __exit__(self, *_: object) -> None:
        self._exit.close()

    def poll(self) -> None:
        """Look after the processes. Raises ConfigRefused."""
        starts_last = LAST in self.plan.services and LAST not in self.supervisor.children
        if starts_last and self.alive.issuperset(self._first()):
            camera = self.plan.camera()
            played_once = camera.source == "replay" and not camera.loop
            self.supervisor.start(LAST, self.plan.capture(), finite=played_once)
        self._start_base()
        self.supervisor.poll()

    def _first(self) -> list[str]:
        """The services between camera and base, which are started before any frame comes."""
        return [name for name in self.plan.services if name not in (LAST, self.plan.base_service)]

    def _start_base(self) -> None:
        """Start the base's processes; its service as soon as the port of a base that is started here is there."""
        port = self.plan.port
        for name, command in self._base.items():
            waits = name == KOBUKI and port is not None and not port.exists()
            if not waits and name not in self.supervisor.children:
                self.supervisor.start(name, command, ground=name == SIMULATION)

    def _connect(self) -> Bus:
        """The bus, when the router answers. Raises ConfigRefused where the router cannot listen."""
        while not self._stop.is_set():
            try:
                return Bus(self.plan.client(VIEWER), self.plan.robot)
            except NotConnected:
                self.supervisor.poll()
                self._stop.wait(TURN)
        raise SystemExit(0)

    def changed(self, service: str, alive: bool) -> None:
        """A service works, or does so no longer."""
        if alive:
            self.alive.add(service)
            log.info("%s is ready", plain(service))
        else:
            self.alive.discard(service)
            if not self._stop.is_set():
                log.info("%s is gone", plain(service))
