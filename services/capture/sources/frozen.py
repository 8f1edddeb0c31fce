"""Whether a camera repeats one picture, as a hung driver does: fresh stamps prove nothing."""

import math
import time

import numpy as np
from numpy.typing import NDArray

from cliffscan.common.runtime.metrics import ServiceMetrics
from cliffscan.services.capture.sources.depth_source import SourceLost

PATIENCE = 0.5  # [s] of repeats until the device counts as lost
REPEATED = "the camera repeats its last picture bit for bit, so its driver hangs"


class FrozenWatch:
    """Remembers the last picture of a live camera, also while its device is opened again.

    No sensor's noise comes twice, so a picture that is equal bit for bit to the last one is that one again.
    """

    def __init__(self, metrics: ServiceMetrics) -> None:
        self._metrics = metrics
        self._last: NDArray[np.uint16] | None = None
        self._since = math.inf  # when the repeats began

    def is_new(self, depth: NDArray[np.uint16]) -> bool:
        """Whether a picture, (rows, columns) [mm], may be published; a repeated one is counted as `frozen` and logged.

        A picture without any return always may: a covered lens or a wall nearer than the sensor measures gives the
        same one for as long as it lasts, it shows nobody free floor, and to open the device again would not help.
        Raises SourceLost when repeats have gone on for PATIENCE.
        """
        if not depth.any():
            return True
        if self._last is None or not np.array_equal(depth, self._last):
            self._last, self._since = depth.copy(), math.inf  # a source may use its buffer again
            return True
        self._metrics.warn_limited("frozen", REPEATED)
        now = time.monotonic()
        self._since = min(self._since, now)
        if now - self._since >= PATIENCE:
            self._since = math.inf  # the device has as long again when it is opened anew
            raise SourceLost(f"{REPEATED}: replug or restart the camera if opening it again does not help")
        return False
