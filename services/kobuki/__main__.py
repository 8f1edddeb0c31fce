"""The base of a TurtleBot 2: odometry and sensors, and commands that cannot make it fall."""

from __future__ import annotations

from contextlib import closing

from common.service import Service, main
from services.kobuki.bridge import Bridge
from services.kobuki.config import KobukiConfig


def serve(service: Service[KobukiConfig]) -> None:
    """Speak with the base until the end."""
    with closing(Bridge(service)) as bridge:
        bridge.listen()
        while service.running:
            bridge.turn()


if __name__ == "__main__":
    main("kobuki", KobukiConfig, serve)
