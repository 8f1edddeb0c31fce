"""The depth image as a picture, and where in it the scan says that the floor ends."""

import io
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from cliffscan.common.contract.camera import Camera, Floats, axes
from cliffscan.common.contract.evidence import EDGES
from cliffscan.common.contract.messages import DepthImage, LaserScan
from cliffscan.view.packet import packet

WIDTH = 320  # [px] of the picture, at least, where the image has so many
QUALITY = 75  # of the JPEG
# Colours of near to far in even steps of lightness, also to colour-blind eyes: cividis from a quarter of it on
CIVIDIS = np.array(
    [
        (67, 78, 108), (90, 95, 110), (111, 112, 115), (132, 130, 121), (155, 148, 118),
        (180, 167, 111), (205, 187, 99), (231, 209, 80), (254, 232, 56),
    ]
)  # fmt: skip
NO_RETURN = (0, 0, 0)


def depth_picture(image: DepthImage, scan: LaserScan | None) -> bytes:
    """The packet of a depth image, and of the edges in the scan that was made of it, where there is one."""
    step = max(image.width // WIDTH, 1)
    picture = Image.fromarray(coloured(image.depth[::step, ::step], image.camera.range[1]))
    jpeg = io.BytesIO()
    picture.save(jpeg, "JPEG", quality=QUALITY)
    u, v = edge_pixels(image.camera, scan) if scan else (np.empty(0), np.empty(0))
    header = {"kind": "depth", "stamp": image.stamp, "width": image.width, "height": image.height}
    arrays: dict[str, NDArray[Any]] = {
        "jpeg": np.frombuffer(jpeg.getvalue(), np.uint8),
        "u": u.astype(np.float32),
        "v": v.astype(np.float32),
    }
    return packet(header, arrays)


def coloured(depth: NDArray[np.uint16], farthest: float) -> NDArray[np.uint8]:
    """The colours of depths (rows, columns) [mm]: (rows, columns, 3). What is beyond `farthest` [m] looks like it."""
    places = np.linspace(0.0, len(CIVIDIS) - 1.0, 256)
    table = np.stack([np.interp(places, np.arange(len(CIVIDIS)), each) for each in CIVIDIS.T], axis=-1)
    table = np.vstack([[NO_RETURN], np.rint(table)]).astype(np.uint8)
    levels = np.minimum(depth * (255.0 / (1000.0 * farthest)), 255.0).astype(np.uint16) + 1
    levels[depth == 0] = 0
    picture: NDArray[np.uint8] = table[levels]
    return picture


def edge_pixels(camera: Camera, scan: LaserScan) -> tuple[Floats, Floats]:
    """Columns u and rows v where the floor ends, beam by beam: (beams,) each, NaN where a beam sees no edge."""
    edge = np.isin(scan.intensities, EDGES) if len(scan.intensities) else np.zeros(len(scan.ranges), np.bool_)
    ranges = np.where(edge & np.isfinite(scan.ranges), scan.ranges, np.nan).astype(np.float64)
    angles = scan.grid().angles()
    forward, left, up = axes(camera.floor)
    x, y, z = (
        ranges * np.cos(angles) * forward[axis] + ranges * np.sin(angles) * left[axis] - camera.floor.d * up[axis]
        for axis in range(3)
    )
    fx, fy, cx, cy = camera.intrinsics
    ahead = np.where(z > 0.0, z, np.nan)
    return fx * x / ahead + cx, fy * y / ahead + cy
