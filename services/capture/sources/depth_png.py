"""A 16-bit greyscale PNG as depths."""

from io import BytesIO

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from cliffscan.services.capture.sources.depth_source import BadFrame

GREY_16 = ("I;16", "I;16B", "I;16L")


def decode_depth(content: bytes, name: str, width: int, height: int) -> NDArray[np.uint16]:
    """A 16-bit greyscale PNG as (height, width) [mm]. name: for people. Raises BadFrame where it is anything else."""
    try:
        with Image.open(BytesIO(content), formats=["PNG"]) as image:
            image.verify()  # reading alone passes over wrong check sums
        with Image.open(BytesIO(content), formats=["PNG"]) as image:
            if image.mode not in GREY_16 or image.size != (width, height):
                size = f"{image.width}x{image.height}"
                raise BadFrame(f"{name}: {size} {image.mode}, expected {width}x{height} 16-bit grey")
            return np.asarray(image, dtype=np.uint16)
    except BadFrame:
        raise
    except Exception as error:  # Pillow lets through whatever bad bytes make its parsers raise
        raise BadFrame(f"{name}: {error}") from error
