"""The cases: a kind of scene, a seed, and the setup in which it is seen."""

import math
import zlib
from collections.abc import Collection
from typing import NamedTuple, Self

import numpy as np

from benchmarks.accuracy.setups import BUILD, DROPS, GLOSSY, LEVEL, MOUNTED, SETUPS, Setup
from cliffscan.common.contract.camera import Camera
from evaluation.scenes.mounts import floor_in_view
from evaluation.scenes.scene import Scene

FAR_SHARE, FARTHER = 0.15, 1.0  # of the scenes may have their edge so much [m] farther than it must be found
MOST_MOUNTED = 0.4  # of the scenes are seen from any mount, the others from a level camera at 0.30 m
GLOSSY_SHARE, OTHER_SHARE = 1 / 40, 1 / 10  # as many more are glossy floors, or of each other setup


class Case(NamedTuple):
    """What to build and how to see it; the same for the same three values."""

    kind: str
    seed: int
    group: str = LEVEL  # the setup in which it is seen, and with which it is scored

    @property
    def setup(self) -> Setup:
        """How it is seen."""
        return SETUPS[self.group]

    @property
    def name(self) -> str:
        """As --only takes it: KIND:SEED where the camera is level, SETUP-KIND:SEED elsewhere."""
        return f"{'' if self.group == LEVEL else f'{self.group}-'}{self.kind}:{self.seed}"

    @classmethod
    def parse(cls, name: str) -> Self:
        """The case of a name. Raises ValueError for another text."""
        words, _, seed = name.partition(":")
        group, _, kind = words.rpartition("-")
        group = group or LEVEL
        if kind not in BUILD or group not in SETUPS:
            known = f"kinds are {', '.join(BUILD)}; setups are {', '.join(SETUPS)}"
            raise ValueError(f"{name!r} is no case, expected KIND:SEED or SETUP-KIND:SEED; {known}")
        return cls(kind, int(seed), group)

    @property
    def safe(self) -> bool:
        """Whether there is no drop."""
        return BUILD[self.kind] not in (*DROPS, *self.setup.drops)

    def rng(self, purpose: str) -> np.random.Generator:
        """The same random numbers for the same purpose, whatever else draws any."""
        setup = LEVEL if self.group == GLOSSY else self.group
        return np.random.default_rng([self.seed, zlib.crc32(f"{setup} {self.kind} {purpose}".encode())])


def camera_of(case: Case) -> Camera:
    """The camera and where it truly is."""
    return case.setup.camera(case.rng("mount"))


def scene_of(case: Case) -> Scene:
    """The scene before that camera."""
    near, far = floor_in_view(camera_of(case))
    if case.rng("reach").random() < FAR_SHARE:
        far += FARTHER
    return BUILD[case.kind](case.rng("scene"), (near, far))


def some_cases(scenes: int, seed: int, setups: Collection[str] = tuple(SETUPS)) -> list[Case]:
    """About that many cases seen by level and mounted cameras, and some more of each other setup.

    In each setup half have drops and half none, where it has both; all kinds come as often.
    """
    mounted = round(MOST_MOUNTED * scenes)
    of_each = {LEVEL: scenes - mounted, MOUNTED: mounted, GLOSSY: math.ceil(GLOSSY_SHARE * scenes)}
    return [
        Case(setup.kind(i), seed * 100_000 + i, name)
        for name, setup in SETUPS.items()
        if name in setups
        for i in range(of_each.get(name, math.ceil(OTHER_SHARE * scenes)))
    ]
