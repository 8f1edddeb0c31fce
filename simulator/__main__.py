"""A robot in a simulated world: its base on a pty for `services.kobuki`, its camera's frames for `services.capture`.

The world's time passes with the clock's. Faults on demand, and the truth, over the control socket; `help` lists them.
"""

import argparse
import logging
import math
from contextlib import ExitStack
from pathlib import Path

from cliffscan.common.runtime.stop_signal import StopSignal
from cliffscan.simulator.frame_server import FrameServer
from cliffscan.simulator.kobuki.__main__ import USAGE_ERROR
from cliffscan.simulator.kobuki.cable import PathError
from cliffscan.simulator.kobuki.drive import WheelModel
from cliffscan.simulator.kobuki.runner import Runner
from cliffscan.simulator.live import Live
from cliffscan.simulator.robot import RobotSimulation
from cliffscan.simulator.sensor_models import MODELS
from cliffscan.simulator.sensors import SENSORS, sensor_camera
from cliffscan.simulator.wire import WireError
from cliffscan.simulator.world import Pose

log = logging.getLogger(__name__)


def options() -> argparse.ArgumentParser:
    """The command line."""
    parser = argparse.ArgumentParser(prog="python -m simulator", description=__doc__)
    parser.add_argument("--world", default="paper_room", metavar="NAME", help="or random:SEED; %(default)s")
    parser.add_argument(
        "--link", type=Path, required=True, metavar="PATH", help="where the driver finds the base's port"
    )
    parser.add_argument("--frames", metavar="ADDRESS", help="where frames are had: a path, or HOST:PORT")
    parser.add_argument("--control", type=Path, metavar="PATH", help="Unix socket for one-line commands")
    parser.add_argument("--rate", type=float, default=30.0, metavar="HZ", help="of the frames, %(default)s")
    parser.add_argument("--start", type=float, nargs=3, default=[0.0, 0.0, 0.0], metavar=("X", "Y", "DEGREES"))
    parser.add_argument("--sensor", choices=SENSORS, default="kinect", help="its camera, %(default)s")
    parser.add_argument("--height", type=float, default=0.30, metavar="M", help="of the mounted camera, %(default)s")
    parser.add_argument("--pitch", type=float, default=0.0, metavar="DEGREES", help="it looks down, %(default)s")
    parser.add_argument("--roll", type=float, default=0.0, metavar="DEGREES", help="it leans right, %(default)s")
    parser.add_argument("--slip-noise", type=float, default=0.0, metavar="√M", help="the encoders' error [m] after 1 m")
    parser.add_argument("--seed", type=int, default=0, help="of the sensor's noise, slip noise and garbage")
    return parser


def make_simulation(arguments: argparse.Namespace) -> RobotSimulation:
    """The simulation that the options describe. Raises ValueError for one that cannot be."""
    if not 0.0 < arguments.rate < math.inf:
        raise ValueError(f"a rate of {arguments.rate} Hz, expected more than 0")
    x, y, degrees = arguments.start
    pitch, roll = math.radians(arguments.pitch), math.radians(arguments.roll)
    camera, model = sensor_camera(arguments.sensor, arguments.height, pitch, roll), MODELS[arguments.sensor]
    wheels = WheelModel(noise=arguments.slip_noise)
    start = Pose(x, y, math.radians(degrees))
    return RobotSimulation(arguments.world, start, arguments.seed, camera, model, wheels)


def main() -> None:
    """Run a simulation until told to end."""
    parser = options()
    arguments = parser.parse_args()
    stop = StopSignal()
    logging.basicConfig(level=logging.INFO, format="%(asctime)s %(levelname)s simulator: %(message)s")
    with ExitStack() as opened:
        try:
            simulation = make_simulation(arguments)
            frames = FrameServer(arguments.frames) if arguments.frames else None
            if frames:
                opened.callback(frames.close)
            live = Live(simulation, frames, arguments.rate)
            runner = opened.enter_context(Runner.open(simulation.base, arguments.link, arguments.control, live.execute))
        except (ValueError, WireError, OSError, PathError) as error:
            opened.close()
            parser.exit(USAGE_ERROR, f"simulator: {error}\n")
        simulation.frame()  # compiles
        log.info("ready: %s%s", runner.place, f", frames at {frames.address}" if frames else "")
        live.run(runner, stop)
    log.info("ended after %.1f s of the simulation", simulation.time)


if __name__ == "__main__":
    main()
