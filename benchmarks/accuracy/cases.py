"""The cases: a kind of scene, a seed, and where the camera is."""

import math
import zlib
from collections.abc import Callable
from typing import NamedTuple, Self

import numpy as np

from cliffscan.common.contract.camera import Camera
from cliffscan.simulator.kinect import kinect_camera
from evaluation.scenes import drops, safe
from evaluation.scenes.drops import Span
from evaluation.scenes.mounts import any_mount, floor_in_view
from evaluation.scenes.scene import Scene

Build = Callable[[np.random.Generator, Span], Scene]

DROPS: tuple[Build, ...] = (drops.hole, drops.hole, drops.kerb, drops.kerb_5cm, drops.stairs, drops.stairwell,
                            drops.platform)  # fmt: skip
SAFE: tuple[Build, ...] = (safe.open_floor, safe.walls, safe.corridor, safe.boxes, safe.tables, safe.railings,
                           safe.sill, safe.ramp_down, safe.ramp_up, safe.lost_returns)  # fmt: skip
GLOSSY = safe.glossy.__name__
BUILD: dict[str, Build] = {build.__name__: build for build in (*DROPS, *SAFE, safe.glossy)}
LEVEL, MOUNTED = "level", "mounted"
FAR_SHARE, FARTHER = 0.15, 1.0  # of the scenes may have their edge so much [m] farther than it must be found
MOST_MOUNTED = 0.4  # of the scenes are seen from any mount, the others from a level camera at 0.30 m


class Case(NamedTuple):
    """What to build and how to see it; the same for the same three values."""

    kind: str
    seed: int
    mount: str = LEVEL

    @property
    def name(self) -> str:
        """As --only takes it: KIND:SEED, or mounted-KIND:SEED."""
        return f"{self.mount + '-' if self.mount == MOUNTED else ''}{self.kind}:{self.seed}"

    @classmethod
    def parse(cls, name: str) -> Self:
        """The case of a name. Raises ValueError for another text."""
        kind, _, seed = name.partition(":")
        bare = kind.removeprefix(f"{MOUNTED}-")
        if bare not in BUILD:
            raise ValueError(f"{name!r} is no case; kinds are {', '.join(BUILD)}")
        return cls(bare, int(seed), LEVEL if bare == kind else MOUNTED)

    @property
    def group(self) -> str:
        """The set in which it is scored."""
        return GLOSSY if self.kind == GLOSSY else self.mount

    @property
    def safe(self) -> bool:
        """Whether there is no drop."""
        return BUILD[self.kind] not in DROPS

    def rng(self, purpose: str) -> np.random.Generator:
        """The same random numbers for the same purpose, whatever else draws any."""
        return np.random.default_rng([self.seed, zlib.crc32(f"{self.mount} {self.kind} {purpose}".encode())])


def camera_of(case: Case) -> Camera:
    """The camera and where it truly is."""
    return any_mount(case.rng("mount")) if case.mount == MOUNTED else kinect_camera()


def scene_of(case: Case) -> Scene:
    """The scene before that camera."""
    near, far = floor_in_view(camera_of(case))
    if case.rng("reach").random() < FAR_SHARE:
        far += FARTHER
    return BUILD[case.kind](case.rng("scene"), (near, far))


def some_cases(scenes: int, seed: int) -> list[Case]:
    """About that many cases: half with drops, half without; all kinds as often; some glossy floors beside them."""
    mounted = round(MOST_MOUNTED * scenes)
    return [
        *_alternating(scenes - mounted, seed, LEVEL),
        *_alternating(mounted, seed, MOUNTED),
        *(Case(GLOSSY, seed * 100_000 + i) for i in range(math.ceil(scenes / 40))),
    ]


def _alternating(count: int, seed: int, mount: str) -> list[Case]:
    return [
        Case((DROPS, SAFE)[i % 2][i // 2 % len((DROPS, SAFE)[i % 2])].__name__, seed * 100_000 + i, mount)
        for i in range(count)
    ]
