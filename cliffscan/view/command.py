"""`cliffscan view` from its options to its end."""

import logging
import os
import socket
import sys
import threading
from collections.abc import Collection
from typing import NoReturn

from cliffscan.common.runtime.network import Network
from cliffscan.common.runtime.service import connect
from cliffscan.common.runtime.stop_signal import StopSignal
from cliffscan.view.access import Access
from cliffscan.view.robots import Robots
from cliffscan.view.server import Server

ENDING = 0.4  # [s]
EVERYWHERE = ("0.0.0.0", "::", "")  # noqa: S104 - compared with, not bound to


def view(
    network: Network, robot: str, where: str, bind: str, port: int, origins: Collection[str], stop: StopSignal
) -> NoReturn:
    """Serve the page until Ctrl-C, and end the process.

    Raises BusError, and ConfigError where the port cannot be had.
    """
    access, robots = Access.to(bind, origins), Robots(robot, where)
    with Server(bind, port, access, robots) as server:
        print(f"cliffscan view: {address(bind, server.port, access.token)}", flush=True)
        if access.token:
            print(
                "Keep this address secret: with it anybody can stop the robot. It is not encrypted.",
                file=sys.stderr,
            )
        bus = connect(network, robot, stop)
        if bus is not None:
            with bus:
                robots.attach(bus)
                looking = threading.Thread(target=robots.run, args=(stop,), name="view robots", daemon=True)
                looking.start()
                stop.wait()
                looking.join(ENDING)
    logging.shutdown()
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(0)  # a thread that sends to a viewer that reads nothing would keep the interpreter from ending


def address(bind: str, port: int, token: str) -> str:
    """What a person opens in a browser."""
    name = socket.gethostname() if bind in EVERYWHERE else bind
    host = f"[{name}]" if ":" in name else name
    return f"http://{host}:{port}/" + (f"?token={token}" if token else "")
