"""Hostile messages for the real services, and the good ones between them that have to be answered at once."""

import contextlib
import queue
import random
import time
from typing import NamedTuple

import msgpack
import numpy as np
import psutil

from cliffscan.common.contract.base_messages import Velocity
from cliffscan.common.contract.message import MessageError
from cliffscan.common.contract.messages import DepthImage, LaserScan
from tests import hostile, scenes
from tests.service.conftest import DEADLINE, image

BATCH = 50  # messages between two good frames
FRAME = 0.033  # [s] between two good frames
SPACING = 0.005  # [s] between two messages, so that all of them are looked at
KEYS = {
    DepthImage: ["camera/depth"],
    LaserScan: ["scan/positive", "scan/negative", "scan/fused"],
    Velocity: ["base/cmd_vel"],
}
COMMANDS = ["led", "sound", "digital_output", "gains", "version", "no_such", "reset_odometry"]
CAMERA = scenes.camera()
DEPTH = scenes.depth(CAMERA, [scenes.HOLE])


class Told(NamedTuple):
    """What a trial told."""

    longest: float  # [s] until a good frame came out as a fused scan, or a request was answered
    growth: int  # [bytes] of the process that grew most, after the first third


class Trial:
    """Sends hostile messages to services that run, and looks at what becomes of good ones."""

    def __init__(self, client, pids) -> None:
        self._client, self._processes = client, [psutil.Process(pid) for pid in pids]
        self._fused: queue.Queue[int] = queue.Queue()  # stamps
        client.session.declare_subscriber(f"{client.robot}/scan/fused", self._arrived)

    def run(self, seed: int, count: int) -> Told:
        """Raises where a good frame is never answered."""
        dice = random.Random(seed)
        self._client.put("camera/depth", msgpack.packb(hostile.air(dice, *hostile.LARGEST)))
        self._good()
        memory, longest = [], 0.0
        for number, case in enumerate(hostile.cases(seed, count)):
            self._send(dice, case)
            if number % BATCH == BATCH - 1:
                longest = max(longest, self._good())
                memory.append([process.memory_info().rss for process in self._processes])
        return Told(longest, _growth(np.array(memory)))

    def _arrived(self, sample) -> None:
        """Some of the fused scans are hostile ones too."""
        with contextlib.suppress(MessageError):
            self._fused.put(LaserScan.decode(sample.payload.to_bytes()).stamp)

    def _send(self, dice: random.Random, case: hostile.Case) -> None:
        """To a key of its kind, or to a command."""
        if case.kind in KEYS:
            self._client.put(dice.choice(KEYS[case.kind]), case.payload)
        else:
            key = f"{self._client.robot}/base/command/{dice.choice(COMMANDS)}"
            for _ in self._client.session.get(key, payload=case.payload):
                pass
        time.sleep(SPACING)

    def _good(self) -> float:
        """How long [s] until a camera's good frames got through three services, or a request, whichever took longer."""
        began, sent = time.monotonic(), set[int]()
        while True:
            sent.add(stamp := time.time_ns())
            self._client.put("camera/depth", image(CAMERA, DEPTH, stamp))
            if self._seen(sent):
                break
            assert time.monotonic() - began < DEADLINE, "no good frame came out"
        seen = time.monotonic()
        assert self._client.ask("base/command/version", {})["ok"]
        return max(seen - began, time.monotonic() - seen)

    def _seen(self, stamps: set[int]) -> bool:
        """Whether a fused scan of one of these frames comes within a frame's time."""
        with contextlib.suppress(queue.Empty):
            while True:
                if self._fused.get(timeout=FRAME) in stamps:
                    return True
        return False


def _growth(memory: np.ndarray) -> int:
    """How much [bytes] the median of the last third is above that of the second: (batches, processes) -> the worst."""
    third = len(memory) // 3
    return int((np.median(memory[-third:], axis=0) - np.median(memory[third : 2 * third], axis=0)).max())
