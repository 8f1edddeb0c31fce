"""Two hosts on this machine, each a network namespace, and the emulated link that joins them. Needs root."""

import json
import os
import subprocess
import sys
from collections.abc import Sequence
from contextlib import AbstractContextManager, ExitStack
from typing import Any, NamedTuple, Self

from benchmarks.link.path import Link

ADDRESSES = "10.77.0.1", "10.77.0.2"
CONGESTION = "/proc/sys/net/ipv4/tcp_congestion_control"


class NoHosts(Exception):
    """No link can be emulated on this machine; the text says what it lacks."""


class Host(NamedTuple):
    """A host: its namespace and its address on the link."""

    namespace: str
    address: str

    @property
    def within(self) -> list[str]:
        """The words before a command that is to run on it."""
        return ["ip", "netns", "exec", self.namespace]


class Hosts(AbstractContextManager["Hosts"]):
    """A robot and a workstation. congestion: the TCP congestion control of both. Raises NoHosts."""

    def __init__(self, congestion: str) -> None:
        number = os.getpid()
        self.robot = Host(f"robot-{number}", ADDRESSES[0])
        self.workstation = Host(f"workstation-{number}", ADDRESSES[1])
        self._congestion = congestion
        self._devices = [f"link{side}-{number}" for side in "ab"]

    def __enter__(self) -> Self:
        if os.geteuid() != 0 or not os.path.exists("/dev/net/tun"):  # noqa: PTH110
            raise NoHosts("network namespaces and TUN devices need root, and /dev/net/tun: run it with sudo")
        with ExitStack() as entered:
            for host in (self.robot, self.workstation):
                ip("netns", "add", host.namespace)
                entered.callback(ip, "netns", "delete", host.namespace)
            words = [sys.executable, "-m", "benchmarks.link.emulator", *self._devices]
            self._emulator = subprocess.Popen(words, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
            entered.callback(self._end_emulator)
            self._answer()
            for device, host, other in zip(self._devices, self._both, reversed(self._both), strict=True):
                self._join(device, host, other)
            self._entered = entered.pop_all()
        return self

    def __exit__(self, *_: object) -> None:
        self._entered.close()

    def set(self, link: Link | None = None, down: bool | None = None) -> list[dict[str, Any]]:
        """Change the link; what each direction, that of the robot first, has carried [bytes] and lost [packets]."""
        asked = {"link": link, "down": down}
        assert self._emulator.stdin
        print(json.dumps({key: value for key, value in asked.items() if value is not None}), file=self._emulator.stdin)
        self._emulator.stdin.flush()
        return self._answer()

    @property
    def _both(self) -> tuple[Host, Host]:
        return self.robot, self.workstation

    def _answer(self) -> list[dict[str, Any]]:
        assert self._emulator.stdout
        line = self._emulator.stdout.readline()
        if not line:
            raise NoHosts("the link's emulator ended: see its own words above")
        answer: list[dict[str, Any]] = json.loads(line)
        return answer

    def _join(self, device: str, host: Host, other: Host) -> None:
        """Put a device of the link into a host; the emulator goes on reading it."""
        ip("link", "set", device, "netns", host.namespace)
        ip("-n", host.namespace, "address", "add", host.address, "peer", other.address, "dev", device)
        for each in ("lo", device):
            ip("-n", host.namespace, "link", "set", each, "up")
        command = ["sh", "-c", f"echo {self._congestion} > {CONGESTION}"]
        done = subprocess.run([*host.within, *command], check=False, capture_output=True)
        if done.returncode:
            raise NoHosts(
                f"this kernel does not let a namespace use TCP congestion control {self._congestion}: choose another "
                "--tcp, or add it to the sysctl net.ipv4.tcp_allowed_congestion_control"
            )

    def _end_emulator(self) -> None:
        assert self._emulator.stdin
        self._emulator.stdin.close()
        self._emulator.wait()


def ip(*words: str) -> None:
    """Configure the network. Raises NoHosts."""
    done = _run(["ip", *words])
    if done.returncode:
        raise NoHosts(f"ip {' '.join(words)}: {done.stderr.strip()}")


def _run(command: Sequence[str]) -> subprocess.CompletedProcess[str]:
    try:
        return subprocess.run(command, check=False, capture_output=True, text=True)
    except FileNotFoundError as error:
        raise NoHosts(f"{command[0]} is not there: install iproute2") from error
