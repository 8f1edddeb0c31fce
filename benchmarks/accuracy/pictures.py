"""A picture of a case: what the sensor saw with each scan's verdicts over it, and the plan of the scene."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Polygon

from benchmarks.accuracy.cases import Case, scene_of
from benchmarks.accuracy.frames import PLANES, Frame, frames_of
from benchmarks.accuracy.polygons import Floats, direction
from benchmarks.accuracy.scans import ANGLES, beams_of
from benchmarks.accuracy.scene import Scene
from benchmarks.accuracy.score import Verdict, judge
from benchmarks.accuracy.sight import floor_points, pixels
from benchmarks.accuracy.truth import Truth, steps, truth_of
from cliffscan.common.contract.beam_fields import Ranges

COLOURS = {
    Verdict.UNCOUNTED: "tab:gray",
    Verdict.FALSE: "magenta",
    Verdict.FOUND: "lime",
    Verdict.EARLY: "red",
    Verdict.LATE: "orange",
    Verdict.MISSED: "blue",
    Verdict.ASTRAY: "deeppink",
}
MARKERS = "+x.1234"
DEPTHS = (500, 4500)  # [mm]
VIEW = (0.0, 5.0, -2.8, 2.8)  # [m] of the plan: x from and to, y from and to


def draw(case: Case, plane: str, scans: Sequence[str], path: Path) -> None:
    """Write the picture of a case's last frame in a plane mode, tracked or not."""
    mode = next(mode for mode in PLANES if plane.startswith(mode))
    frame = [frame for frame in frames_of(case, mode) if frame.plane == plane][-1]
    scene = scene_of(case)
    truth = truth_of(scene, frame.true, ANGLES)
    ranges = {scan: beams.ranges for scan, beams in beams_of(frame, scans).items()}
    figure = Figure(figsize=(5.0 * len(scans), 10.5), layout="constrained")
    figure.suptitle(f"{case.name}, plane {plane}: {frame.true.floor.d:.2f} m, drops {depths(scene)}")
    grid = figure.add_gridspec(2, len(scans), height_ratios=(1, 1.6))
    for place, scan in enumerate(scans):
        view(figure.add_subplot(grid[0, place]), frame, truth, ranges[scan], scan)
    plan(figure.add_subplot(grid[1, :]), scene, truth, ranges)
    figure.savefig(path, dpi=70)


def depths(scene: Scene) -> str:
    """How deep the drops are, as text."""
    return ", ".join(f"{drop.depth:.2f} m" for drop in scene.drops) or "none"


def view(axes: Axes, frame: Frame, truth: Truth, ranges: Ranges, scan: str) -> None:
    """The depth image, and on it each beam's number, or the edge where a number is missing, in the verdict's colour."""
    axes.imshow(np.ma.masked_equal(frame.depth, 0), cmap="bone", vmin=DEPTHS[0], vmax=DEPTHS[1])
    verdicts = judge(ranges, truth)
    told = np.where(verdicts == Verdict.MISSED, truth.edge, ranges)
    column, row, _ = pixels(frame.true, floor_points(ANGLES, np.nan_to_num(told.astype(float), posinf=np.nan)))
    for verdict, colour in COLOURS.items():
        these = (verdicts == verdict) & np.isfinite(told)
        if these.any():
            axes.plot(column[these], row[these], ".", color=colour, ms=3, label=f"{verdict.name.lower()} {these.sum()}")
    axes.set(title=scan, xlim=(0, frame.depth.shape[1]), ylim=(frame.depth.shape[0], 0))
    if axes.get_legend_handles_labels()[0]:
        axes.legend(loc="upper left", fontsize=7)


def plan(axes: Axes, scene: Scene, truth: Truth, ranges: dict[str, Ranges]) -> None:
    """The scene from above, the true edge and each scan's numbers; the robot is at the left and looks right."""
    for drop in scene.drops:
        axes.add_patch(Polygon(drop.outline, color="mistyrose"))
    for piece in scene.obstacles:
        axes.add_patch(Polygon(piece.outline, color="silver" if piece.bottom < 0.4 else "whitesmoke"))
    for patch in scene.glossy:
        axes.add_patch(Polygon(patch, color="lightcyan"))
    slope(axes, scene)
    asked, other = np.where(truth.drop, truth.edge, np.nan), np.where(truth.drop, np.nan, truth.edge)
    axes.plot(*points(asked), "k-", lw=3, alpha=0.5, label="edge that must be found")
    axes.plot(*points(other), "k:", lw=1, label="other edge")
    for marker, (scan, values) in zip(MARKERS, ranges.items(), strict=False):
        axes.plot(*points(values.astype(float)), marker, ms=4, label=scan)
    axes.set(xlim=VIEW[:2], ylim=VIEW[2:], aspect="equal", xlabel="x [m]", ylabel="y [m]")
    axes.legend(loc="center left", bbox_to_anchor=(1.02, 0.5), fontsize=8)
    axes.grid(alpha=0.3)


def slope(axes: Axes, scene: Scene) -> None:
    """The lines at which a ramp starts and ends."""
    if scene.ramp is not None:
        across = direction(scene.ramp.heading + np.pi / 2) * 8.0
        for distance, label in ((scene.ramp.start, "ramp"), (scene.ramp.start + scene.ramp.length, None)):
            middle = direction(scene.ramp.heading) * distance
            axes.plot(*np.stack([middle - across, middle + across]).T, "g--", label=label)


def points(ranges: Floats) -> Floats:
    """Where beams report something on the plan: x and y [m], (2, beams), NaN for no number."""
    finite = np.where(np.isfinite(ranges), ranges, np.nan)
    return (steps(ANGLES) * finite[:, None]).T
