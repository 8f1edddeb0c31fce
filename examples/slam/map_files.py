"""A map as ROS `map_server` reads it: a grey picture and a page of YAML."""

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from examples.slam.wire import Map

FREE, OCCUPIED, UNKNOWN = 254, 0, 205  # grey values
FREE_UP_TO, OCCUPIED_FROM = 25, 65  # percent; in between nothing is known for sure
# Grey p means occupied with (255 - p) / 255: the lower limit is just below that of 205, as map_server's users have it.
YAML = """\
image: {image}
mode: trinary
resolution: {resolution!r}
origin: [{x!r}, {y!r}, 0.0]
negate: 0
occupied_thresh: 0.65
free_thresh: 0.196
"""


def save(grid: Map, folder: Path) -> None:
    """Write `map.pgm` and `map.yaml` into a folder, which is made where it is not there.

    A reader never finds half a file: each takes its name when it is whole. Raises OSError.
    """
    folder.mkdir(parents=True, exist_ok=True)
    _replace(folder / "map.pgm", pgm(grid))
    _replace(folder / "map.yaml", yaml(grid, "map.pgm").encode())


def pgm(grid: Map) -> bytes:
    """The map as a binary PGM; its first row is the top of the picture, the highest y."""
    height, width = grid.cells.shape
    return b"P5\n%d %d\n255\n" % (width, height) + grey(grid.cells)[::-1].tobytes()


def grey(cells: NDArray[np.int8]) -> NDArray[np.uint8]:
    """The grey value of each cell, of the same shape."""
    values = np.full(cells.shape, UNKNOWN, np.uint8)
    values[(cells >= 0) & (cells <= FREE_UP_TO)] = FREE
    values[cells >= OCCUPIED_FROM] = OCCUPIED
    return values


def yaml(grid: Map, image: str) -> str:
    """What `map_server` needs to know of the picture: `origin` is the pose of its lower left corner."""
    return YAML.format(image=image, resolution=grid.resolution, x=float(grid.x), y=float(grid.y))


def _replace(path: Path, content: bytes) -> None:
    unfinished = path.with_name(path.name + ".part")
    unfinished.write_bytes(content)
    unfinished.replace(path)
