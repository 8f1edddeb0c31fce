"""The rays on which the floor is looked for: a fixed fan of pixels, and what a floor makes of each.

The inverse depth of a plane is affine in (u, v), and a sensor's noise is taken to be constant in it. So with the plane
written as s = (a k, b k, k), where a and b are its slopes forward and left against the nominal floor and k = nominal
height over height, each ray's inverse depth is g·s: a linear regression, unbiased, with known noise.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cliffscan.common.contract.camera import Camera, FloorPlane, axes

Floats = NDArray[np.float64]
Singles = NDArray[np.float32]
Flags = NDArray[np.bool_]

BEAMS, RINGS = 42, 64  # rays by azimuth, and by depression, nearest floor first; a beam's rings fill a number's bits
STEEPEST = math.radians(80.0)  # rays nearer the vertical have no useful azimuth
WAVINESS = 0.3e-3  # [m] by which a flat floor is not flat

TILT, RISE = math.radians(8.0), 0.07  # [rad], [m] from the nominal floor that rays are read for, each way


@dataclass(frozen=True)
class FloorRays:
    """Rays from the nearest floor outward: arrays of (BEAMS, RINGS), ring 0 the nearest.

    Inverse depths are in units of each ray's own noise.
    """

    nominal: FloorPlane
    basis: Floats  # (3, 3): the nominal floor's forward, left, up in the optical frame
    pixels: NDArray[np.intp]  # place in the flattened image
    nearest: NDArray[np.uint16]  # [mm] the depths that a floor can have; none outside the image
    farthest: NDArray[np.uint16]
    sigma: Singles  # [1/m]
    slopes: Singles  # (3, BEAMS, RINGS): g over sigma

    def plane(self, s: Floats) -> FloorPlane:
        """The floor that s means."""
        size = float(np.linalg.norm(s))
        nx, ny, nz = (float(each) for each in (s / size) @ self.basis)
        return FloorPlane(nx, ny, nz, self.nominal.d / size)

    def read(self, depth: NDArray[np.uint16]) -> Singles:
        """Inverse depth over noise of each ray: (BEAMS, RINGS); nan where there is no depth that a floor can have.

        depth: (rows, columns) [mm].
        """
        millimetres = depth.reshape(-1)[self.pixels]
        possible = (millimetres >= self.nearest) & (millimetres <= self.farthest)
        inverse = np.full(self.sigma.shape, np.nan, dtype=np.float32)
        np.divide(np.float32(1000.0), millimetres * self.sigma, out=inverse, where=possible)
        return inverse


def floor_rays(camera: Camera, nominal: FloorPlane) -> FloorRays:
    """The rays of `camera` for a floor near `nominal`, in the pixels that can carry a return."""
    basis = np.stack(axes(nominal))
    u, v, inside = _fan(camera, basis, nominal.d)
    slopes = -np.einsum("ij,jkl->ikl", basis, _rays(camera, u, v)) / nominal.d
    predicted = np.maximum(slopes[2], 0.0)
    sigma = np.hypot(camera.noise, predicted * WAVINESS / nominal.d)
    low, high = _limits(camera, slopes, nominal.d, 3.0 * sigma)
    return FloorRays(
        nominal=nominal,
        basis=basis,
        pixels=np.where(inside, v * camera.width + u, 0),
        nearest=np.where(inside, np.ceil(1000.0 / high), 65535).astype(np.uint16),
        farthest=np.where(inside, np.floor(1000.0 / low), 0).astype(np.uint16),
        sigma=sigma.astype(np.float32),
        slopes=(slopes / sigma).astype(np.float32),
    )


def _rays(camera: Camera, u: NDArray[np.intp], v: NDArray[np.intp]) -> Floats:
    """The rays of pixels, of depth 1: (3, ...)."""
    fx, fy, cx, cy = camera.intrinsics
    return np.stack([(u - cx) / fx, (v - cy) / fy, np.ones(u.shape)])


def _fan(camera: Camera, basis: Floats, height: float) -> tuple[NDArray[np.intp], NDArray[np.intp], Flags]:
    """The pixel (u, v) of each ray, and whether it is in the region."""
    azimuths, depressions = _field_of_view(camera, basis, height)
    azimuth, depression = np.meshgrid(azimuths, depressions, indexing="ij")
    level = np.cos(depression)
    directions = np.stack([level * np.cos(azimuth), level * np.sin(azimuth), -np.sin(depression)])
    x, y, z = np.einsum("ij,ikl->jkl", basis, directions)
    ahead = z > 1e-3
    z = np.where(ahead, z, 1.0)
    fx, fy, cx, cy = camera.intrinsics
    u, v = np.rint(fx * x / z + cx), np.rint(fy * y / z + cy)
    left, top, right, bottom = camera.region
    inside = ahead & (u >= left) & (u <= right) & (v >= top) & (v <= bottom)
    return np.where(inside, u, 0).astype(np.intp), np.where(inside, v, 0).astype(np.intp), inside


def _field_of_view(camera: Camera, basis: Floats, height: float) -> tuple[Floats, Floats]:
    """Azimuths (BEAMS,) and depressions (RINGS,) [rad] at which the camera may see floor, the nearest first."""
    first_column, first_row, last_column, last_row = camera.region
    v, u = np.mgrid[first_row:last_row:33j, first_column:last_column:33j]
    forward, left, up = np.einsum("ij,jkl->ikl", basis, _rays(camera, u, v))
    azimuth, depression = np.arctan2(left, forward), np.arctan2(-up, np.hypot(forward, left))
    shallowest = math.atan2(height, 1.5 * camera.range[1]) - TILT
    seen = (depression >= shallowest) & (depression <= STEEPEST)
    if not seen.any():
        seen = np.ones_like(seen)
    right, leftmost = azimuth[seen].min(), azimuth[seen].max()
    far, near = max(shallowest, depression[seen].min()), depression[seen].max()
    return np.linspace(right, leftmost, BEAMS), np.linspace(near, far, RINGS)


def _limits(camera: Camera, slopes: Floats, height: float, slack: Floats) -> tuple[Floats, Floats]:
    """The least and largest inverse depth [1/m] of each ray on a floor within TILT and RISE of the nominal one."""
    rise = min(RISE, height / 2)
    tilt = math.tan(TILT) * (np.abs(slopes[0]) + np.abs(slopes[1])) + slack
    closest, farthest = height / (height - rise), height / (height + rise)
    low = np.minimum(slopes[2] * farthest, slopes[2] * closest) - tilt
    high = np.maximum(slopes[2] * farthest, slopes[2] * closest) + tilt
    near, far = max(camera.range[0], 0.001), camera.range[1]
    return np.maximum(low, 1.0 / far), np.maximum(np.minimum(high, 1.0 / near), 1e-3 + 1.0 / 65.535)
