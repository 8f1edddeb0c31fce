"""Single programs of this project, started for a measurement and ended after it, and what they cost."""

import subprocess
import sys
from collections.abc import Sequence
from contextlib import AbstractContextManager

import psutil


class Started(AbstractContextManager["Started"]):
    """Python modules that run until the context is left; the last that was started ends first.

    within: words before each command, where it is to run on an emulated host.
    """

    def __init__(self, within: Sequence[str] = ()) -> None:
        self.processes: list[subprocess.Popen[bytes]] = []
        self._within = within

    def module(self, name: str, *options: object) -> psutil.Process:
        """Start `python -m NAME OPTIONS`."""
        process = subprocess.Popen([*self._within, sys.executable, "-m", name, *map(str, options)])
        self.processes.append(process)
        return psutil.Process(process.pid)

    def service(self, name: str, robot: str, endpoint: str, *settings: str) -> psutil.Process:
        """Start a service of a robot, a client of the router at an endpoint; settings: SERVICE.KEY=VALUE."""
        options = [word for setting in settings for word in ("--set", setting)]
        where = ["--robot", robot, "--mode", "client", "--connect", endpoint]
        return self.module(f"cliffscan.services.{name}", *where, *options)

    @property
    def died(self) -> list[str]:
        """The command lines of those that have ended by themselves."""
        return [str(process.args) for process in self.processes if process.poll() is not None]

    def __exit__(self, *_: object) -> None:
        for process in reversed(self.processes):
            process.terminate()
            process.wait()


def cpu(process: psutil.Process) -> float:
    """CPU time [s] so far."""
    times = process.cpu_times()
    return float(times.user + times.system)
