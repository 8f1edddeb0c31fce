"""What is truly there, beam by beam, as a scan is judged by it."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from cliffscan.common.contract.camera import Floats

Mask = NDArray[np.bool_]


class Truth(NamedTuple):
    """Each (beams,); distances from the point of the floor below the camera.

    A beam is judged as `drop` where its edge could be found; whatever its kind, a number nearer than `earliest` is
    false.
    """

    edge: Floats  # [m] where the floor ends by a drop, seen or not; inf = nowhere
    allowed: Floats  # [m] error allowed at the edge
    earliest: Floats  # [m] a nearer number is false; inf = any number is
    drop: Mask  # the edge must be found
    oblique: Mask  # not `drop` only because the edge moves by more than allowed within the beam's width
    undecidable: Mask  # a ramp goes out of the sensor's sight: no frame tells it from stairs
    sinking: Mask  # undecidable, but enough of the ramp is seen to foresee where it will be lost
