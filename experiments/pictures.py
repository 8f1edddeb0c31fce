"""The pictures: of a world, one for each group of the paper's figures; of a recorded frame, one with everything."""

from pathlib import Path

from cliffscan.simulator.truth import outlines
from cliffscan.simulator.world import World
from evaluation.pictures.cloud import Bands, Kind, cloud, kinds
from evaluation.pictures.panels import Scene, depth_panel, kind_panel, points_panel, scan_panel
from evaluation.pictures.plan import Extent, extent_of
from evaluation.pictures.sheet import IMAGE_HEIGHT, write_sheet
from experiments.frames import Frame

IN_PAPER = ("depth", "floor points", "points below", "farthest_point", "virtual_floor", "paper")
FIGURES = {  # of the paper, by world and by what is shown
    world: dict(zip(IN_PAPER, figures, strict=True))
    for world, figures in (("paper_room", (11, 12, 17, 13, 18, 21)), ("paper_room_open", (14, 15, 19, 16, 20, 22)))
}
TITLES = {
    "depth": "Depth image",
    "floor points": "Floor points from above",
    "points below": "Points below the floor from above",
    "farthest_point": "Farthest point (algorithm 1)",
    "virtual_floor": "Virtual floor projection (algorithm 2)",
    "paper": "The paper's: both combined (algorithm 3)",
    "near_edge": "Near edge (ours)",
    "negative": "Negative: the configured methods combined",
    "positive": "Positive: projection",
    "fused": "Fused: positive and negative",
}
EVERY_KIND = [kind for kind in Kind if kind is not Kind.NOTHING]
AHEAD, ASIDE = 5.4, 2.8  # [m] shown of a simulated world: as far as the sensor reaches


def world_pictures(out: Path, world: World, frame: Frame, bands: Bands) -> list[Path]:
    """Three pictures of a frame of a simulated world, with what is truly there: depth, points, scans."""
    name, image, scans = world.name, frame.image, frame.scans
    points = cloud(image)
    found = kinds(points, bands)
    scene = Scene(Extent(AHEAD, ASIDE), scans["fused"], outlines(world))

    def title(what: str) -> str:
        figure = FIGURES.get(name, {}).get(what)
        return f"{_title(what)}, fig. {figure}" if figure else _title(what)

    depth = [depth_panel(image, title("depth")), kind_panel(found, "What each pixel is, by its height")]
    from_above = [
        points_panel(scene, points, found, [Kind.FLOOR], title("floor points")),
        points_panel(scene, points, found, [Kind.BELOW], title("points below")),
    ]
    each = [scan_panel(scene, scan, title(what)) for what, scan in scans.items()]
    return [
        write_sheet(out / f"{name}_depth.png", f"{name}: what the Kinect sees", depth, 2, IMAGE_HEIGHT),
        write_sheet(out / f"{name}_points.png", f"{name}: its points over the true outline", from_above, 2),
        write_sheet(out / f"{name}_scans.png", f"{name}: each scan over the true outline", each, 3),
    ]


def recorded_picture(path: Path, title: str, frame: Frame, bands: Bands) -> Path:
    """One picture of a recorded frame: its depth, what each pixel is, its points, its scans over the points."""
    image, scans = frame
    points = cloud(image)
    found = kinds(points, bands)
    scene = Scene(extent_of(points, list(scans.values())), scans["fused"])
    panels = [
        depth_panel(image, "Depth image"),
        kind_panel(found, "What each pixel is, by its height"),
        points_panel(scene, points, found, EVERY_KIND, "Points from above"),
        *(scan_panel(scene, scan, _title(what), (points, found)) for what, scan in scans.items()),
    ]
    return write_sheet(path, f"{title}: camera {image.camera.floor.d:.2f} m above the floor plane", panels, 3)


def _title(what: str) -> str:
    return TITLES.get(what, what.replace("_", " ").capitalize())
