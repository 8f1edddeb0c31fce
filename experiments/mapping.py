"""The mapping experiment (figures 23 to 25): one drive, mapped from the positive scan, the paper's and ours."""

from __future__ import annotations

import math
import time
from collections.abc import Iterator, Mapping, Sequence
from itertools import pairwise
from pathlib import Path
from typing import NamedTuple

from rich.progress import Progress

from cliffscan.common.contract.camera import Floats
from cliffscan.common.contract.map_messages import OccupancyGrid
from cliffscan.common.contract.topics import VELOCITY
from cliffscan.common.runtime.latest_queue import LatestQueue
from cliffscan.services.capture.config import CaptureConfig
from cliffscan.simulator.world import World
from experiments.collect import TURN, Failed, Watch, tell
from experiments.drive import Look, Step, To
from experiments.film import Scenery, write_film
from experiments.map_pictures import map_picture
from experiments.map_score import MapScore, pose_errors, score
from experiments.map_system import REACH, SCANS, Mapper, MapSystem, Setting
from experiments.map_truth import Ground, seen
from experiments.run import Run, telling
from experiments.service_log import ServiceLog
from experiments.survey import Survey
from experiments.tables import map_table
from experiments.truth_feed import Truth

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
ROOM = 1024  # samples that may wait to be read
# of the first second: kobuki is started before its port is there, and fuse is ready before it hears both its sides
EXPECTED = ("kobuki: port_lost", "kobuki: baseline", "fuse: incomplete")
VIEWS = 4  # of so many viewpoints one is asked what is in view


class Drive(NamedTuple):
    """What a drive brought."""

    survey: Survey
    truth: Mapping[int, Truth]  # by stamp [ns]

    @property
    def maps(self) -> dict[str, OccupancyGrid]:
        """The last map of each scan, by name."""
        return {name: grids[-1] for name, grids in self.survey.maps.items()}


def run_mapping(run: Run, steps: Sequence[Step], mapper: Mapper, film: Path | None) -> None:
    """Drive, draw the maps, tell how good they are; and make a `film` of it where one is wanted."""
    born = time.monotonic()
    mount = run.config("capture", CaptureConfig)
    setting = Setting(WORLD, mapper, run.out, run.overrides, mount.mounted_floor())
    world = World(WORLD)
    ground = Ground.of(world)
    with telling(run) as (progress, log):
        drive = drive_round(run, setting, steps, log, progress)
        task = progress.add_task(f"{WORLD}: scoring and drawing", total=None)
        viewpoints = [truth.viewpoint for truth in drive.truth.values()][::VIEWS]
        in_view = ground.edges[seen(world, ground.edges, viewpoints, mount.kinect(), REACH)]
        way = [truth.pose for truth in drive.truth.values()]
        maps, scores = drive.maps, score_all(drive, ground, in_view)
        map_picture(run.out / "maps.png", maps, scores, ground, in_view, way)
        if film:
            write_film(film, drive.survey.frames, drive.truth, Scenery(ground, run.bands(), drive.survey.maps))
        progress.remove_task(task)
    run.tell(map_table(scores, about(drive)), "maps.md", born)


def score_all(drive: Drive, ground: Ground, in_view: Floats) -> dict[str, MapScore]:
    """The score of every map by name; in_view: points (n, 2) [m] of the edges that should be on it."""
    true = {stamp: truth.pose for stamp, truth in drive.truth.items()}
    poses = drive.survey.poses
    return {name: score(grid, ground, in_view, pose_errors(poses[name], true)) for name, grid in drive.maps.items()}


def drive_round(run: Run, setting: Setting, steps: Sequence[Step], log: ServiceLog, progress: Progress) -> Drive:
    """Run the services, lead the robot along the steps, and end all. Raises Failed, ConfigRefused, SystemExit."""
    task = progress.add_task(setting.world, total=None)
    with MapSystem(setting, run.stop) as system:
        run.stop.patient = True
        survey = Survey(steps, SCANS, system.bus.publisher(VELOCITY))
        for state in lead(system, survey):
            tell(progress, log, EXPECTED)
            told = f"{setting.world}: {state}"
            progress.update(task, completed=survey.done, total=survey.total, description=told)
            if run.stop.is_set():
                raise SystemExit
        truth = dict(system.feed.by_stamp) if system.feed else {}
        progress.update(task, completed=survey.done, description=f"{setting.world}: ending the services")
    run.stop.patient = False
    progress.update(task, description=setting.world)
    if any(each.fallen for each in truth.values()):
        raise Failed(f"the robot fell in {setting.world}")
    return Drive(survey, truth)


def lead(system: MapSystem, survey: Survey) -> Iterator[str]:
    """Let the survey hear all that is said until it is done; what is waited for, again and again. Raises Failed."""
    queue: LatestQueue[tuple[str, bytes]] = LatestQueue(ROOM)
    for path in survey.paths:
        system.bus.subscribe(path, lambda key, payload: queue.put((key, payload)))
    watch = Watch(system, wanted=system.wanted, work="driving")
    while survey.done < survey.total:
        watch.look(survey)
        yield watch.state
        arrived = queue.get(TURN)
        if arrived:
            survey.hear(*arrived, go=watch.started and system.feed is not None)


def about(drive: Drive) -> str:
    """What the drive was like, in one line."""
    truth = list(drive.truth.values())
    seconds = truth[-1].time - truth[0].time
    way = sum(math.dist(one.pose[:2], other.pose[:2]) for one, other in pairwise(truth))
    given_up = len(drive.survey.driver.given_up)
    gate = f", {given_up} way points not reached" if given_up else ""
    return f"{way:.1f} m in {seconds:.0f} s of the simulation, {len(truth)} frames, {truth[-1].bumps} bumps{gate}"
