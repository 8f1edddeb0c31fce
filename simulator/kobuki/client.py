"""The other end of the control socket, for tests and for whoever plays with a running base from Python."""

import json
import socket
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from cliffscan.simulator.kobuki.control import ControlError
from cliffscan.simulator.unix_socket import connect_to

PATIENCE = 10.0  # [s]


class Watch:
    """Events as they happen: each command that the base hears, and a driver that opens or closes the port."""

    def __init__(self, connection: socket.socket) -> None:
        self._connection = connection
        self._events = connection.makefile("r", encoding="utf-8")
        _ask(connection, self._events.readline, "watch")

    def __iter__(self) -> Iterator[dict[str, Any]]:
        """Wait for one event after the other. Raises TimeoutError where none comes; ends with the base."""
        for line in self._events:
            yield json.loads(line)

    def close(self) -> None:
        """Watch no more."""
        self._events.close()
        self._connection.close()


class Remote:
    """A running base. Raises OSError where none listens at the path, TimeoutError where one does not answer."""

    def __init__(self, path: Path, patience: float = PATIENCE) -> None:
        self._path = path
        self._patience = patience

    def tell(self, line: str) -> str:
        """Give one command; the answer. Raises ControlError where the base refuses it."""
        with (
            connect_to(self._path, self._patience) as connection,
            connection.makefile("r", encoding="utf-8") as answers,
        ):
            return _ask(connection, answers.readline, line)

    def state(self) -> dict[str, Any]:
        """What the base was told, what it does, and where it truly is."""
        state: dict[str, Any] = json.loads(self.tell("state"))
        return state

    def watch(self) -> Watch:
        """Everything the driver does from now on."""
        return Watch(connect_to(self._path, self._patience))


def _ask(connection: socket.socket, readline: Any, line: str) -> str:  # noqa: ANN401
    connection.sendall(line.encode() + b"\n")
    answer = str(readline()).rstrip("\n")
    if not answer:
        raise ConnectionError("the base is gone")
    if answer.startswith("error: "):
        raise ControlError(answer.removeprefix("error: "))
    return answer
