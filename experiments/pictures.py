"""The pictures: of a world, one for each group of the paper's figures; of a recorded frame, one with everything."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from cliffscan.common.contract.evidence import Evidence
from cliffscan.common.contract.messages import LaserScan
from cliffscan.simulator.truth import outlines
from cliffscan.simulator.world import World
from experiments.cloud import Bands, Kind, cloud, kinds
from experiments.frames import Frame, name_of
from experiments.panels import Scene, depth_panel, kind_panel, points_panel, scan_panel
from experiments.plan_view import Extent, extent_of
from experiments.sheet import IMAGE_HEIGHT, evidence_legend, kind_legend, world_legend, write_sheet

FIGURES = {  # of the paper, by world and by what is shown
    "paper_room": {
        "depth": 11,
        "floor points": 12,
        "points below": 17,
        "farthest_point": 13,
        "virtual_floor": 18,
        "negative": 21,
    },
    "paper_room_open": {
        "depth": 14,
        "floor points": 15,
        "points below": 19,
        "farthest_point": 16,
        "virtual_floor": 20,
        "negative": 22,
    },
}
TITLES = {
    "depth": "Depth image",
    "floor points": "Floor points from above",
    "points below": "Points below the floor from above",
    "farthest_point": "Farthest point (algorithm 1)",
    "virtual_floor": "Virtual floor projection (algorithm 2)",
    "near_edge": "Near edge (ours)",
    "negative": "Negative: all methods combined (algorithm 3)",
    "positive": "Positive: projection",
    "fused": "Fused: positive and negative",
}
EVERY_KIND = [kind for kind in Kind if kind is not Kind.NOTHING]
AHEAD, ASIDE = 5.4, 2.8  # [m] shown of a simulated world: as far as the sensor reaches


def world_pictures(out: Path, world: World, frame: Frame, bands: Bands) -> list[Path]:
    """Three pictures of a frame of a simulated world, with what is truly there: depth, points, scans."""
    points = cloud(frame.image)
    found = kinds(points, bands)
    scene = Scene(Extent(AHEAD, ASIDE), frame.scans["scan/fused"], outlines(world))

    def title(what: str) -> str:
        figure = FIGURES.get(world.name, {}).get(what)
        return f"{_title(what)}, fig. {figure}" if figure else _title(what)

    depth = [
        depth_panel(frame.image, title("depth")),
        kind_panel(frame.image, found, "What each pixel is, by its height"),
    ]
    from_above = [
        points_panel(scene, points, found, [Kind.FLOOR], title("floor points")),
        points_panel(scene, points, found, [Kind.BELOW], title("points below")),
    ]
    scans = [scan_panel(scene, scan, title(name_of(path))) for path, scan in frame.scans.items()]
    seen = evidence_legend(_evidence(frame.scans.values()))
    name = world.name
    return [
        write_sheet(
            out / f"{name}_depth.png",
            f"{name}: what the Kinect sees",
            depth,
            2,
            kind_legend(list(Kind)),
            IMAGE_HEIGHT,
        ),
        write_sheet(
            out / f"{name}_points.png",
            f"{name}: its points over the true outline (grey: all others)",
            from_above,
            2,
            [*kind_legend([Kind.FLOOR, Kind.BELOW]), *world_legend()],
        ),
        write_sheet(
            out / f"{name}_scans.png", f"{name}: each scan over the true outline", scans, 3, [*world_legend(), *seen]
        ),
    ]


def recorded_picture(path: Path, title: str, frame: Frame, bands: Bands) -> Path:
    """One picture of a recorded frame: its depth, what each pixel is, its points, its scans over the points."""
    points = cloud(frame.image)
    found = kinds(points, bands)
    scans = frame.scans
    scene = Scene(extent_of(points, list(scans.values())), scans["scan/fused"])
    panels = [
        depth_panel(frame.image, "Depth image"),
        kind_panel(frame.image, found, "What each pixel is, by its height"),
        points_panel(scene, points, found, EVERY_KIND, "Points from above"),
        *(scan_panel(scene, scan, _title(name_of(each)), (points, found)) for each, scan in scans.items()),
    ]
    height = f"camera {frame.image.camera.floor.d:.2f} m above the floor plane"
    legend = [*kind_legend(list(Kind)), *evidence_legend(_evidence(scans.values()))]
    return write_sheet(path, f"{title}: {height}", panels, 3, legend)


def _title(what: str) -> str:
    return TITLES.get(what, what.replace("_", " ").capitalize())


def _evidence(scans: Iterable[LaserScan]) -> list[Evidence]:
    """The kinds of evidence that the scans tell, each once."""
    told = {value for scan in scans for value in scan.intensities.tolist()}
    return [kind for kind in Evidence if kind in told and kind is not Evidence.NOTHING]
