"""The mapping experiment (figures 23 to 25): one drive, mapped from the positive scan, the paper's and ours."""

import math
import time
from collections.abc import Mapping, Sequence
from contextlib import ExitStack
from itertools import pairwise
from typing import NamedTuple

from cliffscan.common.contract.camera import Floats
from cliffscan.common.contract.map_messages import OccupancyGrid
from cliffscan.common.contract.topics import VELOCITY
from cliffscan.services.capture.config import CaptureConfig
from cliffscan.simulator.world import Pose, World
from evaluation.map_score import DEFINITIONS, MapScore, pose_errors, score
from evaluation.pictures.maps import map_panel
from evaluation.pictures.sheet import write_sheet
from evaluation.processes.steering import Look, Step, To
from evaluation.processes.truth_feed import Truth, TruthFeed
from evaluation.processes.watch import Failed, Watch
from evaluation.tables import Table, percent
from evaluation.truth.world_truth import Ground, seen
from experiments.map_system import REACH, SCANS, WANTED, Mapper, map_system
from experiments.run import DRIVER, RECORDER, Display, Run, telling
from experiments.survey import Survey

WORLD = "landing"
ROUND: Sequence[Step] = (
    To(2.0, 0.2),
    Look(-60),
    To(2.1, -1.1),
    Look(30),
    Look(-90),
    To(-0.7, -1.1),
    Look(-90),
    Look(100),
    To(-0.7, 0.4),
    To(0.0, 0.0),
)
# of the first second: kobuki is started before its port is there, and fuse is ready before it receives both its sides
EXPECTED = ("kobuki: port_lost", "kobuki: baseline", "fuse: incomplete")
VIEWS = 4  # of so many viewpoints one is asked what is in view


HEADINGS = ("map of", "free beyond", "blocked", "edges", "rms", "final")
NAMES = {"positive": "positive, fig. 24", "paper": "the paper's, fig. 25", "fused": "fused (ours)"}
HEIGHT = 4.4  # [inch] of a map's panel


class Drive(NamedTuple):
    """What a drive brought, and what the world truly is."""

    survey: Survey
    truth: Mapping[int, Truth]  # by stamp [ns]
    ground: Ground
    in_view: Floats  # (n, 2) [m] points of the edges that should be on a map

    @property
    def way(self) -> list[Pose]:
        """Where the robot was."""
        return [truth.pose for truth in self.truth.values()]

    @property
    def maps(self) -> dict[str, OccupancyGrid]:
        """The last map of each scan, by name."""
        return {name: grids[-1] for name, grids in self.survey.maps.items()}

    def scores(self) -> dict[str, MapScore]:
        """The score of every map by name."""
        true = {stamp: truth.pose for stamp, truth in self.truth.items()}
        errors = {name: pose_errors(told, true) for name, told in self.survey.poses.items()}
        return {name: score(grid, self.ground, self.in_view, errors[name]) for name, grid in self.maps.items()}


def run_mapping(run: Run, steps: Sequence[Step], mapper: Mapper) -> None:
    """Drive, draw the maps and tell how good they are. Raises Failed, ConfigRefused, SystemExit."""
    born = time.monotonic()
    with telling(run) as display:
        drive = drive_round(run, mapper, steps, display)
        task = display.progress.add_task(f"{WORLD}: scoring and drawing", total=None)
        scores = drive.scores()
        panels = [
            map_panel(grid, drive.ground, drive.in_view, drive.way, title(name, scores[name]))
            for name, grid in drive.maps.items()
        ]
        text = "One drive on the landing, mapped from three scans, over the true outline"
        write_sheet(run.out / "maps.png", text, panels, len(panels), HEIGHT)
        display.progress.remove_task(task)
    run.tell(map_table(scores, about(drive)), "maps.md", born)


def title(name: str, score: MapScore) -> str:
    """What a map is made of, and how good it is."""
    return (
        f"Map: {NAMES[name]}\n{score.free_beyond:.2f} m² free beyond an edge, "
        f"{score.blocked:.2f} m² blocked wrongly,\n{percent(score.edges, 0)} of the edges seen are on the map"
    )


def map_table(scores: Mapping[str, MapScore], drive: str) -> Table:
    """How good each map is; `drive` tells in a few words what it was made of."""
    rows = [
        (
            NAMES[name],
            *(f"{area:.2f} m²" for area in each[:2]),
            percent(each.edges),
            *(f"{100 * error:.1f} cm" for error in each[3:]),
        )
        for name, each in scores.items()
    ]
    return Table(f"The same drive mapped from three scans: {drive}", HEADINGS, rows, 1, DEFINITIONS)


def drive_round(run: Run, mapper: Mapper, steps: Sequence[Step], display: Display) -> Drive:
    """Run the services, lead the robot along the steps, and end all. Raises Failed, ConfigRefused, SystemExit."""
    mount = run.config("capture", CaptureConfig)
    with map_system(run, WORLD, mapper, mount.mounted_floor()) as hosts, ExitStack() as opened:
        run.stop.patient = True
        bus, driver = (opened.enter_context(hosts.bus(role)) for role in (RECORDER, DRIVER))
        survey, watch = Survey(steps, SCANS, driver.publisher(VELOCITY)), Watch(hosts, WANTED, "driving")
        feed: TruthFeed | None = None
        for path, payload in display.attend(bus, watch, survey, run.stop, WORLD, EXPECTED):
            if feed is None and "capture" in hosts.alive:
                feed = TruthFeed(f"{hosts.robot.plan.folder}/frames")
                opened.callback(feed.close)
            survey.receive(path, payload, go=watch.started and feed is not None)
        truth = dict(feed.by_stamp) if feed else {}
    run.stop.patient = False
    display.ended(WORLD)
    if any(each.fallen for each in truth.values()):
        raise Failed(f"the robot fell in {WORLD}")
    world = World(WORLD)
    ground = Ground.of(world)
    viewpoints = [each.viewpoint for each in truth.values()][::VIEWS]
    return Drive(survey, truth, ground, ground.edges[seen(world, ground.edges, viewpoints, mount.kinect(), REACH)])


def about(drive: Drive) -> str:
    """What the drive was like, in one line."""
    truth = list(drive.truth.values())
    seconds = truth[-1].time - truth[0].time
    way = sum(math.dist(one.pose[:2], other.pose[:2]) for one, other in pairwise(truth))
    given_up = len(drive.survey.driver.given_up)
    gate = f", {given_up} way points not reached" if given_up else ""
    return f"{way:.1f} m in {seconds:.0f} s of the simulation, {len(truth)} frames, {truth[-1].bumps} bumps{gate}"
