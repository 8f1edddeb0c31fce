"""negative, positive and fuse in one process: all scans of each depth image, for one robot, several or all."""

from __future__ import annotations

import argparse
from collections.abc import Mapping

from cliffscan.common.runtime import options
from cliffscan.common.runtime.bus import Bus
from cliffscan.common.runtime.config import ServiceConfig
from cliffscan.common.runtime.service import execute, on_bus, reporting
from cliffscan.common.runtime.stop_signal import StopSignal
from cliffscan.services.perception.configs import load
from cliffscan.services.perception.fleet import Fleet


def serve(arguments: argparse.Namespace, configs: Mapping[str, ServiceConfig]) -> None:
    """Serve the robots that are asked for until SIGTERM or Ctrl-C. Raises BusError as Bus does."""
    robots = options.robots(arguments)

    def work(bus: Bus, stop: StopSignal) -> None:
        fleet = Fleet(bus, robots, configs, stop)
        with reporting(fleet.publish_statuses, stop):
            if not stop.is_set():
                fleet.serve()

    on_bus(options.network(arguments), options.ROBOT, work)


if __name__ == "__main__":
    execute("perception", options.add_robots, load, serve)
