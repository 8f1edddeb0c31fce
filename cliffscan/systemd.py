"""`cliffscan systemd`: units that start one part of a robot, or all of it, when its machine starts.

A unit for each process, so that each may reach no more than it must: a device of its own, or none.
"""

import grp
import pwd
import re
import sys
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

from cliffscan.common.runtime.config import ConfigError
from cliffscan.system import Plan

TARGET = "cliffscan.target"
CACHE = "cliffscan"  # folder in /var/cache, for compiled kernels
PLAIN = re.compile(r"[\w@%+=:,./-]+")  # a word that systemd takes as it is

# Devices by the name of their driver in /proc/devices, and the modules that put it there: a name that is not there when
# a unit starts lets nothing in later. Distributions name a group differently: the first one counts.
Drivers = tuple[Sequence[str], Sequence[str], Sequence[Sequence[str]]]
NONE: Drivers = (), (), ()
CAMERA: Drivers = ("char-usb_device", "char-video4linux"), ("videodev",), (("plugdev",), ("video",))
BASE: Drivers = ("char-ttyUSB", "char-ttyACM"), ("usbserial", "cdc_acm"), (("dialout", "uucp"),)

# What no process needs. MemoryDenyWriteExecute is left out: numba compiles.
HARDENING = """\
NoNewPrivileges=yes
CapabilityBoundingSet=
ProtectSystem=strict
ProtectHome=read-only
PrivateTmp=yes
ProtectProc=invisible
ProtectClock=yes
ProtectHostname=yes
ProtectKernelLogs=yes
ProtectKernelModules=yes
ProtectKernelTunables=yes
ProtectControlGroups=yes
RestrictAddressFamilies=AF_UNIX AF_INET AF_INET6 AF_NETLINK
RestrictNamespaces=yes
RestrictRealtime=yes
RestrictSUIDSGID=yes
LockPersonality=yes
SystemCallArchitectures=native
SystemCallFilter=@system-service
UMask=0077"""


def units(plan: Plan, user: str) -> dict[str, str]:
    """The text of each unit by its file's name."""
    commands = {"router": plan.router(), **{name: plan.service(name) for name in plan.services}}
    made = {f"cliffscan-{name}.service": _service(plan, name, command, user) for name, command in commands.items()}
    return {TARGET: _target(plan, list(made)), **made}


def _target(plan: Plan, services: Sequence[str]) -> str:
    part = f", the {plan.part}'s part" if plan.part else ""
    return f"""\
[Unit]
Description=cliffscan of {plan.robot}{part}
Wants={" ".join(services)}

[Install]
WantedBy=multi-user.target
"""


def _service(plan: Plan, name: str, command: Sequence[str], user: str) -> str:
    modules = [f"modprobe@{module}.service" for module in _drivers(plan, name)[1]]
    after = ["network-online.target", "time-sync.target", *([] if name == "router" else ["cliffscan-router.service"])]
    return f"""\
[Unit]
Description=cliffscan {name} of {plan.robot}
Documentation=https://github.com/cliffscan/cliffscan/tree/main/docs
After={" ".join([*after, *modules])}
Wants={" ".join(["network-online.target", *modules])}
PartOf={TARGET}
StartLimitIntervalSec=0

[Service]
ExecStart={" ".join(map(_word, command))}
User={user}
Restart=always
RestartSec=1
# a configuration that is refused will be refused again
RestartPreventExitStatus=2
# the last process to end is the one that stops the base
KillMode=control-group
TimeoutStopSec=10
Environment=PYTHONUNBUFFERED=1 NUMBA_CACHE_DIR=/var/cache/{CACHE}
CacheDirectory={CACHE}
{chr(10).join(_devices(plan, name))}
{HARDENING}
"""


def _drivers(plan: Plan, name: str) -> Drivers:
    """Of the devices that a process opens."""
    return CAMERA if name == "capture" else BASE if name == plan.base_service else NONE


def _devices(plan: Plan, name: str) -> Iterator[str]:
    """What a process may open, and the groups of this machine that let it."""
    drivers, _, groups = _drivers(plan, name)
    if not drivers:
        yield "PrivateDevices=yes"
        return
    yield "DevicePolicy=closed"
    yield from (f"DeviceAllow={driver} rw" for driver in drivers)
    here = [found for names in groups if (found := next(filter(_exists, names), ""))]
    if here:
        yield f"SupplementaryGroups={' '.join(here)}"


def _exists(group: str) -> bool:
    try:
        grp.getgrnam(group)
    except KeyError:
        return False
    return True


def _word(word: str) -> str:
    """A word of a command line as systemd reads it: % and $ mean something there, and a blank ends a word."""
    escaped = word.replace("%", "%%").replace("$", "$$")
    if PLAIN.fullmatch(escaped):
        return escaped
    return '"' + escaped.replace("\\", "\\\\").replace('"', '\\"').replace("\n", "\\n") + '"'


def print_units(plan: Plan, user: str, folder: Path | None) -> int:
    """Print the units, or write them to a folder; and what is to be done with them. Raises ConfigError."""
    made = units(plan, user)
    if folder:
        _write(folder, made)
    else:
        print("\n".join(f"# /etc/systemd/system/{name}\n{text}" for name, text in made.items()))
    print(*_next(user, folder), sep="\n", file=sys.stderr)
    return 0


def _write(folder: Path, made: Mapping[str, str]) -> None:
    """Write units to a folder. Raises ConfigError."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
        for name, text in made.items():
            (folder / name).write_text(text, "utf-8")
    except OSError as error:
        raise ConfigError(f"--out {error.filename}: {error.strerror}; name a folder that you may write") from error


def _next(user: str, folder: Path | None) -> Iterator[str]:
    """What a person does next."""
    try:
        pwd.getpwnam(user)
    except KeyError:
        yield f"There is no user {user} here: sudo useradd --system --home-dir /var/lib/{user} {user}"
    if folder:
        yield f"sudo cp {folder}/cliffscan* /etc/systemd/system/ && sudo systemctl daemon-reload"
        yield f"sudo systemctl enable --now {TARGET}"
    else:
        yield "Each unit goes into the file that the line above it names; --out DIR writes them all."
