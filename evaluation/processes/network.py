"""A place on this machine's network that nobody uses."""

import socket


def free_endpoint() -> str:
    """A Zenoh endpoint of this machine, on a TCP port on which nobody listens."""
    with socket.create_server(("127.0.0.1", 0)) as probe:
        return f"tcp/127.0.0.1:{probe.getsockname()[1]}"
