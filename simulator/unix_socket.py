"""Unix sockets: to listen at a path, and to connect to one."""

import socket
from pathlib import Path


def listen_at(path: Path) -> socket.socket:
    """A socket that listens at a path; one left behind by a process that died is replaced. Raises OSError."""
    listener = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
    try:
        if path.is_socket() and not _answers(path):
            path.unlink()
        listener.bind(str(path))
    except OSError:
        listener.close()
        raise
    listener.listen()
    return listener


def connect_to(path: Path, patience: float) -> socket.socket:
    """A connection that waits for an answer that long [s]. Raises OSError where nobody listens at the path."""
    connection = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
    connection.settimeout(patience)
    try:
        connection.connect(str(path))
    except OSError:
        connection.close()
        raise
    return connection


def _answers(path: Path) -> bool:
    with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as probe:
        return probe.connect_ex(str(path)) == 0
