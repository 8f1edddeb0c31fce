"""The map of a SLAM as a picture."""

import io

import numpy as np
from PIL import Image

from cliffscan.common.contract.map_messages import OccupancyGrid
from cliffscan.view.packet import packet

FREE, OCCUPIED, UNKNOWN = range(3)  # the picture's values; the page has their colours
FREE_BELOW, OCCUPIED_FROM = 20, 65  # values of a cell, as map_server takes them


def map_picture(name: str, grid: OccupancyGrid) -> bytes:
    """The packet of a map: a grey PNG of FREE, OCCUPIED and UNKNOWN, its first row the one of the lowest y."""
    cells = grid.data.reshape(grid.height, grid.width)
    classes = np.full(cells.shape, UNKNOWN, np.uint8)
    classes[(cells >= 0) & (cells < FREE_BELOW)] = FREE
    classes[cells >= OCCUPIED_FROM] = OCCUPIED
    png = io.BytesIO()
    Image.fromarray(classes).save(png, "PNG", compress_level=1)
    header = {
        "kind": "map",
        "name": name,
        "stamp": grid.stamp,
        "width": grid.width,
        "height": grid.height,
        "resolution": grid.resolution,
        "origin": grid.origin,
    }
    return packet(header, {"png": np.frombuffer(png.getvalue(), np.uint8)})
