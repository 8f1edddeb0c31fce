"""Where the floor is in each frame: near where the mount has it, and where the nearest floor seen has it."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from cliffscan.common.contract.camera import STEEPEST_AXIS, Camera, FloorPlane
from cliffscan.common.contract.limits import HIGHEST_CAMERA
from cliffscan.services.capture.floor.fit import Fit, Unseen, find
from cliffscan.services.capture.floor.mount import Mount
from cliffscan.services.capture.floor.rays import FloorRays, floor_rays

MISMATCH = 0.026  # [m] between the camera's height measured and as it was told: more than a tape is wrong


class FloorTracker:
    """Estimates the floor plane of each frame of a camera whose mount is about `nominal`: within 5° and 5 cm.

    note: why the last frame's plane was kept from an earlier one, or what is odd of the measured one; or empty.
    measured: whether the last frame's plane was measured in it.
    residual: rms height [m] of the floor's rays over the last plane measured; nan before the first.
    share: which part of the rays that may have seen floor lie on the last frame's, 0 to 1.
    """

    def __init__(self, nominal: FloorPlane) -> None:
        self.nominal = nominal
        self.note = ""
        self.measured = True
        self.residual = math.nan
        self.share = 0.0
        self._floor = nominal
        self._mount = Mount(nominal.d)
        self._rays: tuple[Camera, FloorRays] | None = None
        self._turn = 0

    def update(self, depth: NDArray[np.uint16], camera: Camera) -> FloorPlane:
        """The floor of this frame; the last one again where none is seen.

        depth: (rows, columns) [mm], 0 = no return; the floor that the camera brings does not count.
        """
        rays = self._rays_of(camera)
        prior = self._mount.prior()
        self._turn += 1
        try:
            fit = find(rays, depth, prior, self._turn)
            self._floor = _possible(rays.plane(fit.belief.mean))
        except Unseen as why:
            self._mount.miss()
            self.measured, self.share = False, 0.0
            self.note = f"floor not seen, {why}: keeping the last plane"
            return self._floor
        self._mount.learn(fit.belief, prior.belief)
        self._tell(fit)
        return self._floor

    def _tell(self, fit: Fit) -> None:
        self.measured, self.residual, self.share = True, fit.residual, fit.share
        rise = self._mount.rise
        self.note = ""
        if abs(rise) > MISMATCH:
            self.note = (
                f"the floor is {100 * abs(rise):.0f} cm {'lower' if rise > 0 else 'higher'} than the mount has it: "
                "measure the mount with `cliffscan calibrate`; if it is right, the depth's scale is wrong by "
                f"{abs(rise) / self.nominal.d:.0%}"
            )

    def _rays_of(self, camera: Camera) -> FloorRays:
        if self._rays is None or self._rays[0] != camera:
            self._rays = camera, floor_rays(camera, self.nominal)
        return self._rays[1]


def tracker_of(nominal: FloorPlane, last: FloorTracker | None) -> FloorTracker:
    """The last tracker, or a new one: a frame that comes with another nominal floor is of another mount."""
    return last if last and last.nominal == nominal else FloorTracker(nominal)


def _possible(floor: FloorPlane) -> FloorPlane:
    """The same plane. Raises Unseen where common.contract.camera.check_camera refuses a camera over it."""
    if abs(floor.nz) > STEEPEST_AXIS or floor.d > HIGHEST_CAMERA:
        raise Unseen("the camera looks straight down or is too high")
    return floor
