"""The base of a TurtleBot 2: odometry and sensors, and commands that cannot make it fall."""

from contextlib import closing

from cliffscan.common.runtime.service import Service, main
from cliffscan.services.kobuki.config import KobukiConfig
from cliffscan.services.kobuki.io_loop import IoLoop


def serve(service: Service[KobukiConfig]) -> None:
    """Speak with the base until the end."""
    with closing(IoLoop(service)) as loop:
        loop.listen()
        while service.running:
            loop.turn()


if __name__ == "__main__":
    main("kobuki", KobukiConfig, serve)
