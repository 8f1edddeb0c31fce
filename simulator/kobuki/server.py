"""A Unix socket for one-line commands; each gets one line back. `watch` has everything told that the driver does."""

import contextlib
import json
import socket
from collections.abc import Callable
from pathlib import Path

from cliffscan.simulator.kobuki.cable import PathError
from cliffscan.simulator.kobuki.control import ControlError
from cliffscan.simulator.kobuki.report import Fields
from cliffscan.simulator.unix_socket import listen_at

LONGEST_LINE = 1000  # [bytes]
READ_SIZE = 4096  # [bytes]


class Client:
    """Somebody who gives commands."""

    def __init__(self, connection: socket.socket) -> None:
        self.connection = connection
        self.watching = False
        self.gone = False
        self._pending = b""

    def lines(self) -> list[str]:
        """The lines that are complete by now."""
        try:
            while data := self.connection.recv(READ_SIZE):
                self._pending += data
            self.gone = True
        except BlockingIOError:
            pass
        except OSError:
            self.gone = True
        *whole, self._pending = self._pending.split(b"\n")
        self.gone |= len(self._pending) > LONGEST_LINE
        return [line.decode(errors="replace") for line in whole]

    def tell(self, line: str) -> None:
        """Send a line. Who does not read is left, for the base waits for nobody."""
        try:
            self.connection.sendall(line.encode() + b"\n")
        except OSError:
            self.gone = True


class ControlServer:
    """Listens at a path. Raises PathError where it cannot, or where another process does already."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self._clients: list[Client] = []
        try:
            self._listener = listen_at(path)
        except OSError as error:
            raise PathError(f"cannot listen at {path}: {error.strerror or error}") from error
        self._listener.setblocking(False)

    def files(self) -> list[int]:
        """What to wait on."""
        return [self._listener.fileno(), *(client.connection.fileno() for client in self._clients)]

    def serve(self, execute: Callable[[str], str]) -> None:
        """Answer all that was asked since the last time."""
        self._accept()
        for client in self._clients:
            for line in client.lines():
                client.tell(self._answer(client, line, execute))
        self._part()

    def tell(self, event: Fields) -> None:
        """Let those who watch know."""
        for client in self._clients:
            if client.watching:
                client.tell(json.dumps(event))

    def close(self) -> None:
        """Leave nothing behind."""
        for client in self._clients:
            client.connection.close()
        self._listener.close()
        self.path.unlink(missing_ok=True)

    def _accept(self) -> None:
        with contextlib.suppress(BlockingIOError):
            while True:
                connection, _ = self._listener.accept()
                connection.setblocking(False)
                self._clients.append(Client(connection))

    def _answer(self, client: Client, line: str, execute: Callable[[str], str]) -> str:
        if line.strip() == "watch":
            client.watching = True
            return "ok"
        try:
            return execute(line)
        except ControlError as error:
            return f"error: {error}"

    def _part(self) -> None:
        for client in self._clients:
            if client.gone:
                client.connection.close()
        self._clients = [client for client in self._clients if not client.gone]
