"""The picture of a scan that differs: its depth image, and each beam then and now."""

from pathlib import Path

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure

from cliffscan.common.contract.messages import DepthImage, LaserScan
from cliffscan.recording.scan_comparison import Difference

THEN, NOW, DIFFERS = "#004488", "#BF4F00", "#F0E442"  # told apart by colour-blind eyes and in grey
SIZE, DPI = (9.0, 10.0), 110  # [inch]
NO_RETURN = "black"
DEPTH = ListedColormap(colormaps["cividis"](np.linspace(0.25, 1.0, 256)))  # its darkest is not black


def draw(image: DepthImage, then: LaserScan, now: LaserScan, difference: Difference, path: str, file: Path) -> None:
    """Write the picture of a scan at `path`. Raises OSError."""
    figure = Figure(SIZE, layout="constrained")
    above, below = figure.subplots(2, 1, height_ratios=(1, 1))
    _depth(figure, above, image)
    _beams(below, then, now, difference)
    count = int(difference.any.sum())
    below.set_title(f"{path}: {count} of {len(difference.by)} beams differ")
    figure.savefig(file, dpi=DPI)


def _depth(figure: Figure, axes: Axes, image: DepthImage) -> None:
    metres = np.where(image.depth > 0, image.depth * 0.001, np.nan)
    axes.set_facecolor(NO_RETURN)
    drawn = axes.imshow(metres, cmap=DEPTH, interpolation="nearest", vmax=image.camera.range[1])
    figure.colorbar(drawn, ax=axes, label="depth [m], black: no return")
    axes.set_title(f"frame {image.seq}, stamp {image.stamp}")
    axes.set_xticks([])
    axes.set_yticks([])


def _beams(axes: Axes, then: LaserScan, now: LaserScan, difference: Difference) -> None:
    """Numbers as dots, clear floor as lines, over what differs; from left to right as the camera sees it."""
    azimuths = np.degrees(then.grid().angles())
    half = 0.5 * np.degrees(then.angle_increment)
    whole_height = axes.get_xaxis_transform()
    axes.fill_between(azimuths, 0, 1, difference.any, step="mid", color=DIFFERS, linewidth=0, transform=whole_height)
    for scan, colour, marker, style, name in ((then, THEN, "o", "-", "recorded"), (now, NOW, "x", "--", "now")):
        axes.plot(azimuths, scan.up_to("clear"), color=colour, linestyle=style, linewidth=1.0, label=f"clear, {name}")
        axes.plot(azimuths, scan.ranges, color=colour, marker=marker, markersize=3.0, linestyle="", label=name)
    axes.set_xlim(azimuths[-1] + half, azimuths[0] - half)
    axes.set_ylim(bottom=0.0)
    axes.set_xlabel("azimuth [deg], yellow: differs")
    axes.set_ylabel("range [m]")
    axes.legend(ncols=2)
