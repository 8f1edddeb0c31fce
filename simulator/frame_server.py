"""Hands the newest frame to whoever is connected; who reads slowly misses some, and holds nobody up."""

import contextlib
import socket
import threading
from pathlib import Path

from cliffscan.simulator import wire


class FrameServer:
    """Listens at an address. Raises OSError where it cannot, WireError for what is no address."""

    def __init__(self, address: str) -> None:
        self._listener = wire.listen(address)
        self._path = Path(address) if "/" in address else None
        self._changed = threading.Condition()  # guards the next four
        self._closed = False
        self._newest = b""
        self._number = 0
        self._connections: set[socket.socket] = set()
        threading.Thread(target=self._accept, daemon=True).start()

    @property
    def address(self) -> str:
        """Where it listens; with port 0, the port that it got."""
        return str(self._path) if self._path else "{}:{}".format(*self._listener.getsockname()[:2])

    @property
    def wanted(self) -> bool:
        """Whether anybody is connected."""
        return bool(self._connections)

    def offer(self, frame: bytes) -> None:
        """Let everybody have this frame who is ready for another one."""
        with self._changed:
            self._newest, self._number = frame, self._number + 1
            self._changed.notify_all()

    def close(self) -> None:
        """Hang up on everybody, and leave nothing behind."""
        self._listener.shutdown(socket.SHUT_RDWR)  # wakes the thread that accepts
        self._listener.close()
        if self._path:
            self._path.unlink(missing_ok=True)
        with self._changed:
            self._closed = True
            for connection in self._connections:
                with contextlib.suppress(OSError):  # it has hung up already
                    connection.shutdown(socket.SHUT_RDWR)
            self._connections.clear()
            self._changed.notify_all()

    def _accept(self) -> None:
        with contextlib.suppress(OSError):  # closed
            while True:
                connection, _ = self._listener.accept()
                with self._changed:
                    if self._closed:
                        connection.close()
                        return
                    self._connections.add(connection)
                    self._changed.notify_all()
                    newest = self._number
                threading.Thread(target=self._serve, args=(connection, newest), daemon=True).start()

    def _serve(self, connection: socket.socket, seen: int) -> None:
        with connection, contextlib.suppress(OSError):  # hung up
            while frame := self._next(connection, seen):
                seen, data = frame
                connection.sendall(data)
        with self._changed:
            self._connections.discard(connection)
            self._changed.notify_all()

    def _next(self, connection: socket.socket, seen: int) -> tuple[int, bytes] | None:
        """The next frame after one of that number; None at the end."""
        with self._changed:
            self._changed.wait_for(lambda: self._number > seen or connection not in self._connections)
            return (self._number, self._newest) if connection in self._connections else None
