"""A picture of a case: for each scan what the sensor saw with the verdicts over it, and the scene from above."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from benchmarks.accuracy.cases import Case, scene_of
from benchmarks.accuracy.frames import PLANES, Frame, frames_of
from benchmarks.accuracy.scans import ANGLES, beams_of
from cliffscan.common.contract.beam_fields import Ranges
from cliffscan.common.contract.camera import Floats
from evaluation import palette
from evaluation.pictures.plan import Extent, Plot, draw_pieces, prepare
from evaluation.pictures.sheet import Panel, label, write_sheet
from evaluation.scenes.polygons import direction
from evaluation.scenes.scene import Scene
from evaluation.score import judge
from evaluation.truth.beam_truth import Truth
from evaluation.truth.scene_truth import steps, truth_of
from evaluation.truth.sight import floor_points, pixels

EXTENT = Extent(5.0, 2.8)  # [m] of the plan


def draw(case: Case, plane: str, scans: Sequence[str], path: Path) -> Path:
    """Write the picture of a case's last frame in a plane mode, tracked or not; returns its path."""
    mode = next(mode for mode in PLANES if plane.startswith(mode))
    frame = [frame for frame in frames_of(case, mode) if frame.plane == plane][-1]
    scene = scene_of(case)
    truth = truth_of(scene, frame.true, ANGLES)
    ranges = {scan: beams.ranges.astype(float) for scan, beams in beams_of(frame, scans).items()}
    views = [view(frame, truth, told, scan) for scan, told in ranges.items()]
    plans = [plan(scene, truth, told, scan) for scan, told in ranges.items()]
    depths = ", ".join(f"{drop.depth:.2f} m" for drop in scene.drops) or "none"
    title = f"{case.name}, plane {plane}: {frame.true.floor.d:.2f} m, drops {depths}"
    return write_sheet(path, title, [*views, *plans], len(scans))


def view(frame: Frame, truth: Truth, ranges: Ranges, scan: str) -> Panel:
    """The depth image, and on it each beam's number, or the edge where a number is missing, by its verdict."""

    def draw(plot: Plot) -> None:
        axes = plot.axes
        axes.set_facecolor(palette.NO_RETURN)
        axes.imshow(np.ma.masked_equal(frame.depth, 0), cmap=palette.DEPTH)
        column, row, _ = pixels(frame.true, floor_points(ANGLES, np.nan_to_num(placed(ranges, truth), posinf=np.nan)))
        axes.set(xlim=(0, frame.depth.shape[1]), ylim=(frame.depth.shape[0], 0))
        label(axes, scan)
        judged(plot, np.column_stack([column, row]), ranges, truth)

    return draw


def plan(scene: Scene, truth: Truth, ranges: Ranges, scan: str) -> Panel:
    """The scene from above, its true edge and a scan's numbers."""

    def draw(plot: Plot) -> None:
        axes = plot.axes
        prepare(axes, EXTENT)
        axes.set_facecolor(palette.PIECES["floor"].colour)
        draw_pieces(plot, scene.outlines(), upward=True)
        for patch in scene.glossy:
            plot.area(patch[:, ::-1], palette.GLOSSY, 1.2)
        if scene.ramp is not None:
            across, ahead = direction(scene.ramp.heading + np.pi / 2) * 8.0, direction(scene.ramp.heading)
            for distance in (scene.ramp.start, scene.ramp.start + scene.ramp.length):
                ends = np.stack([ahead * distance - across, ahead * distance + across])
                plot.line(ends[:, ::-1], palette.RAMP, 2.0)
        asked, other = np.where(truth.drop, truth.edge, np.nan), np.where(truth.drop, np.nan, truth.edge)
        for edge, how in ((asked, palette.EDGE_ASKED), (other, palette.EDGE_OTHER)):
            plot.line(points(edge), how, 3.0)
        label(axes, scan)
        judged(plot, points(placed(ranges, truth)), ranges, truth)

    return draw


def placed(ranges: Ranges, truth: Truth) -> Floats:
    """Where a beam's dot is [m]: at its number, or at the edge that it must find and does not: (beams,)."""
    return np.where(truth.drop & ~np.isfinite(ranges), truth.edge, ranges)


def judged(plot: Plot, points: Floats, ranges: Ranges, truth: Truth) -> None:
    """Dots at points (beams, 2) by the verdict of each beam."""
    verdicts = judge(ranges, truth)
    for verdict, mark in palette.VERDICTS.items():
        plot.dots(points[verdicts == verdict], mark, 5.0, every=8)


def points(ranges: Floats) -> Floats:
    """Where beams report something on the plan: left and ahead [m], (beams, 2), NaN for no number."""
    finite = np.where(np.isfinite(ranges), ranges, np.nan)
    return (steps(ANGLES) * finite[:, None])[:, ::-1]
