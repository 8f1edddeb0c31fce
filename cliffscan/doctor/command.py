"""`cliffscan doctor`: look at this machine and at all that arrives of a robot, for a few seconds."""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

from cliffscan.common.runtime import options
from cliffscan.common.runtime.bus import Bus
from cliffscan.common.runtime.config import ServiceConfig, load, meant_for
from cliffscan.common.runtime.endpoints import parse
from cliffscan.common.runtime.network import BusError, NotConnected
from cliffscan.common.runtime.secure import SecureError, unreadable
from cliffscan.common.runtime.service import package_version
from cliffscan.common.runtime.stop_signal import StopSignal
from cliffscan.doctor import devices, host
from cliffscan.doctor.finding import Finding, Level, fault, ok, warning, worst
from cliffscan.doctor.observation import Observation, observe
from cliffscan.doctor.verdicts import verdicts
from cliffscan.parts import GATE, KOBUKI, ROBOT, WORKSTATION
from cliffscan.plain import plain
from cliffscan.services.capture.config import CaptureConfig
from cliffscan.services.kobuki.config import KobukiConfig

if TYPE_CHECKING:
    from cliffscan.common.runtime.identity import Identity

C = TypeVar("C", bound=ServiceConfig)

KEYS, NETWORK = "keys", "network"


def doctor(arguments: argparse.Namespace, stop: StopSignal) -> int:
    """Print a line for each finding; 1 where one is a fault. Raises ConfigError as other commands do."""
    findings = []
    for finding in _look(arguments, stop):
        findings.append(finding)
        print(f"{finding.level.value:8} {finding.subject:20} {plain(finding.text)}", flush=True)
    return 1 if worst(findings) is Level.FAULT else 0


def _look(arguments: argparse.Namespace, stop: StopSignal) -> Iterator[Finding]:
    yield host.check_clock(host.clock_state(), arguments.part)
    if arguments.part or _beyond(arguments.connect):
        yield host.check_congestion()
    keys = list(check_keys(arguments.secure, arguments.connect, arguments.robot))
    yield from keys
    try:
        bus = Bus(options.network(arguments), arguments.robot)
    except BusError as error:
        waits = isinstance(error, NotConnected) and worst(keys) is not Level.FAULT
        remedy = "; start `cliffscan up` or `cliffscan router`, or name another with --connect" if waits else ""
        yield fault(NETWORK, f"{error}{remedy}")
        yield from check_devices(arguments, Observation())
        return
    with bus:
        bus.watch_door()
        seen = observe(bus, arguments.seconds, stop)
    yield from check_devices(arguments, seen)
    if not (seen.alive or seen.statuses or seen.streams):
        yield fault(NETWORK, f"nothing of robot {arguments.robot} arrives: is `cliffscan up` running, under that name?")
        return
    yield from verdicts(seen, package_version())


def check_devices(arguments: argparse.Namespace, seen: Observation) -> Iterator[Finding]:
    """Base and camera, where they may be at this machine. Raises ConfigError."""
    if arguments.part == WORKSTATION:
        return
    port = Path(_config(KOBUKI, KobukiConfig, arguments).port)
    source = _config("capture", CaptureConfig, arguments).source
    if seen.body and seen.body.simulated:
        yield ok(devices.BASE, "the base is simulated")
    elif GATE in seen.alive:
        yield ok(devices.BASE, f"{GATE} guards a base of another make")
    else:
        yield devices.check_port(port, _absent(arguments.part, KOBUKI in seen.alive))
    if seen.camera and seen.camera.simulated:
        yield ok(devices.CAMERA, "the camera is simulated or recorded")
    elif source in ("", "kinect"):
        yield devices.check_kinect(_absent(arguments.part, "capture" in seen.alive))


def check_keys(folder: Path | None, connect: list[str], robot: str) -> Iterator[Finding]:
    """The keys of each role that is here."""
    if not folder:
        if _beyond(connect):
            yield warning(KEYS, "none: whoever reaches that router can drive the robot: `cliffscan keys init`")
        return
    roles = sorted(each.parent.name for each in folder.glob("*/cert.pem") if each.parent.name != "ca")
    if not roles:
        yield fault(
            KEYS,
            unreadable(folder)
            or f"{folder}: has none: copy the folders of this host's roles to it (`cliffscan keys init`)",
        )
    for role in roles:
        yield _check_role(folder, role, robot)


def _check_role(folder: Path, role: str, robot: str) -> Finding:
    identity = import_module("cliffscan.common.runtime.identity")
    subject = f"{KEYS} of {role}"
    try:
        found: Identity = identity.examine(folder / role, role, [robot])
    except SecureError as error:
        return fault(subject, str(error))
    if found.days < identity.SOON:
        return warning(subject, f"end in {found.days} days: `cliffscan keys renew` where they were made")
    return ok(subject, f"valid for {found.days} days")


def _config(service: str, kind: type[C], arguments: argparse.Namespace) -> C:
    """A service's configuration. Raises ConfigError."""
    overrides = [override for override in arguments.set if meant_for(service, override)]
    return load(service, kind, arguments.config, overrides)


def _absent(part: str | None, elsewhere: bool) -> devices.Absent:
    """How bad it is that a device is not at this machine: it must be at the robot, and may be elsewhere."""
    if part == ROBOT:
        return fault
    if elsewhere:
        return lambda subject, _: ok(subject, "not at this machine; its service runs where it is")
    return warning


def _beyond(endpoints: list[str]) -> bool:
    """Whether another machine is connected to."""
    return any(parse(each).beyond for each in endpoints)
