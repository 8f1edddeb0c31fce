"""A Kobuki on a pty: open the link with any driver. Faults on demand over the control socket; `help` lists them."""

import argparse
import logging
from pathlib import Path

from cliffscan.common.runtime.stop_signal import StopSignal
from cliffscan.simulator.kobuki.base import Base
from cliffscan.simulator.kobuki.cable import PathError
from cliffscan.simulator.kobuki.drive import RampedWheels, WheelModel
from cliffscan.simulator.kobuki.firmware import DEAD_TIME, Firmware
from cliffscan.simulator.kobuki.kinematics import Wheels
from cliffscan.simulator.kobuki.line import Line
from cliffscan.simulator.kobuki.runner import Runner, run
from cliffscan.simulator.kobuki.versions import Identity, Version

USAGE_ERROR = 2

log = logging.getLogger(__name__)


def options() -> argparse.ArgumentParser:
    """The command line."""
    model, identity = WheelModel(), Identity()
    parser = argparse.ArgumentParser(prog="python -m simulator.kobuki", description=__doc__)
    parser.add_argument("--link", type=Path, required=True, metavar="PATH", help="where the driver finds the port")
    parser.add_argument("--control", type=Path, metavar="PATH", help="Unix socket for one-line commands")
    parser.add_argument("--firmware", default=str(identity.firmware), metavar="VERSION", help="%(default)s")
    parser.add_argument("--slip", type=float, default=0.0, metavar="SHARE", help="of each wheel's way that is lost")
    parser.add_argument("--slip-noise", type=float, default=model.noise, metavar="√M", help="error [m] after 1 m")
    parser.add_argument("--acceleration", type=float, default=model.acceleration, metavar="M/S²", help="%(default)s")
    parser.add_argument("--deceleration", type=float, default=model.deceleration, metavar="M/S²", help="%(default)s")
    parser.add_argument(
        "--dead-time", type=float, default=DEAD_TIME, metavar="S", help="from a command to the wheels, %(default)s"
    )
    parser.add_argument("--seed", type=int, default=0, help="of slip noise and garbage")
    return parser


def make_base(arguments: argparse.Namespace) -> Base:
    """The base that the options describe. Raises ValueError for one that cannot be."""
    slip = Wheels(arguments.slip, arguments.slip)
    model = WheelModel(arguments.acceleration, arguments.deceleration, slip, arguments.slip_noise)
    identity = Identity(firmware=Version.parse(arguments.firmware))
    firmware = Firmware(RampedWheels(model, arguments.seed), identity, arguments.dead_time)
    return Base(firmware, Line(arguments.seed))


def main() -> None:
    """Run a base until told to end."""
    parser = options()
    arguments = parser.parse_args()
    stop = StopSignal()
    logging.basicConfig(level=logging.INFO, format="%(asctime)s %(levelname)s base: %(message)s")
    try:
        base = make_base(arguments)
    except ValueError as error:
        parser.exit(USAGE_ERROR, f"base: {error}\n")
    try:
        with Runner.open(base, arguments.link, arguments.control) as runner:
            log.info("ready: %s", runner.place)
            run(runner, stop)
    except PathError as error:
        parser.exit(USAGE_ERROR, f"base: {error}\n")
    log.info("ended after %d packets", base.firmware.packets)


if __name__ == "__main__":
    main()
