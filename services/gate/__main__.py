"""The safety gate for a base of any make: commands and odometry in, velocities that cannot make it fall out."""

from contextlib import closing

from cliffscan.common.runtime.service import Service, main
from cliffscan.services.gate.config import GateConfig
from cliffscan.services.gate.loop import GateLoop


def serve(service: Service[GateConfig]) -> None:
    """Guard the base until the end."""
    with closing(GateLoop(service)) as loop:
        loop.listen()
        service.ready()
        while service.running:
            loop.turn()


if __name__ == "__main__":
    main("gate", GateConfig, serve)
