"""All that viewers of one robot see. It is received while there is a viewer, and made when one has room for it.

Each topic is received by a thread of its own, and a sender asks from another one. So copies are walked here: a walk
over what another thread adds to is an error.
"""

import threading
import time
from collections import deque
from collections.abc import Callable
from typing import Any, NamedTuple

from cliffscan.common.contract import topics
from cliffscan.common.contract.base_messages import BaseState, Odometry, SafetyState
from cliffscan.common.contract.description import RobotDescription
from cliffscan.common.contract.map_messages import OccupancyGrid, Pose2D
from cliffscan.common.contract.messages import DepthImage, LaserScan
from cliffscan.common.runtime.bus import Bus
from cliffscan.health import Health
from cliffscan.status import Board
from cliffscan.view.depth_picture import depth_picture
from cliffscan.view.feeds import Feeds, Sample
from cliffscan.view.ground import RememberedGround
from cliffscan.view.map_picture import map_picture
from cliffscan.view.outbox import Make, Outbox
from cliffscan.view.packet import packet
from cliffscan.view.scene import scene
from cliffscan.view.words import felt, why

PERIODS = {"depth": 0.06, "ground": 0.2, "state": 0.1, "map": 0.5}  # [s] between two packets of a kind, at least
IMAGES = 4  # depth images that may wait for their scan
SCANLESS = 0.5  # [s] without a scan, after which depth images are shown without one
OLD = 3.0  # [s] after which a robot of which nothing came is not there
GONE = ("gone", "not found")  # states of a service
MAPS = (topics.MAP, topics.MAP_OF_PLUGIN.named("*"))
POSES = (topics.POSE, topics.POSE_OF_PLUGIN.named("*"))


class Once:
    """Bytes that are made at most once, when the first viewer has room for them."""

    def __init__(self, make: Callable[[], bytes]) -> None:
        self._make: Callable[[], bytes] | None = make
        self._made = b""
        self._lock = threading.Lock()

    def __call__(self) -> bytes:
        """The bytes."""
        with self._lock:
            if self._make is not None:
                self._made, self._make = self._make(), None
        return self._made


class Told(NamedTuple):
    """A message that is one, and when [s] it came by the steady clock: what is kept is decoded first."""

    message: Any
    at: float


class Looker(NamedTuple):
    """One who looks: where packets are offered, and what offers its own state anew."""

    outbox: Outbox
    refresh: Callable[[], None]


class RobotView:
    """One robot, for all who look at it."""

    def __init__(self, bus: Bus, robot: str) -> None:
        self.robot = robot
        self._bus = bus
        self.feeds = Feeds(bus, robot)
        self._lookers: list[Looker] = []
        self._lock = threading.Lock()
        self._cancel: list[Callable[[], None]] = []
        self._board: Board | None = None  # while anybody looks
        self._forget()

    def _forget(self) -> None:
        self._ground = RememberedGround()
        self._images: deque[Sample[DepthImage]] = deque(maxlen=IMAGES)
        self._last: dict[str, Told] = {}
        self._maps: dict[str, Make] = {}
        self._poses: dict[str, Pose2D] = {}
        self._healths: list[Health] = []

    def join(self, looker: Looker) -> None:
        """Offer all that comes to one more."""
        with self._lock:
            self._lookers = [*self._lookers, looker]
            if len(self._lookers) == 1:
                self._open()
        for name, make in list(self._maps.items()):
            looker.outbox.offer(f"map {name}", make)

    def leave(self, looker: Looker) -> None:
        """Offer it nothing any more."""
        with self._lock:
            self._lookers = [each for each in self._lookers if each is not looker]
            if not self._lookers:
                self._close()

    def _open(self) -> None:
        listen = self.feeds.listen
        self._cancel = [
            listen(topics.SCAN_FUSED, self._scanned),
            listen(topics.DEPTH, self._pictured),
            listen(topics.ODOMETRY, self._moved),
            listen(topics.SAFETY, self._decided),
            listen(topics.BASE_STATE, self._felt),
            listen(topics.DESCRIPTION, self._described),
            *(listen(topic, self._mapped) for topic in MAPS),
            *(listen(topic, self._located) for topic in POSES),
        ]
        beside = self._bus.beside(self.robot)
        self._cancel.append(beside.retract)
        self._board = Board(beside)

    def _close(self) -> None:
        for cancel in self._cancel:
            cancel()
        self._cancel = []
        self._board = None
        self._forget()

    def examine(self) -> None:
        """Look how the services fare; waits for the network."""
        board = self._board
        if board is not None:
            self._healths = board.healths()
            self._offer("ground", self._make_ground)

    @property
    def found(self) -> bool:
        """Whether anything of the robot is received."""
        now = time.monotonic()
        lives = any(health.state not in GONE for health in self._healths)
        return lives or any(now - told.at < OLD for told in list(self._last.values()))

    def state(self) -> dict[str, object]:
        """What the page shows beside its pictures; ages [s] are by this machine's clock."""
        now = time.monotonic()
        return {
            "scan_age": self._age("scan", now),
            "safety": self._with_age("safety", now, _safety),
            "base": self._with_age("base", now, _base),
            "odometry": self._with_age("odometry", now, _odometry),
            "services": [_service(health) for health in self._healths],
            "radius": self._ground.hull.outer,
            "footprint": self._ground.footprint,
            "poses": {name: pose.pose for name, pose in list(self._poses.items())},
        }

    def _offer(self, kind: str, make: Make) -> None:
        for looker in self._lookers:
            looker.outbox.offer(kind, make)

    def _keep(self, name: str, sample: Sample[Any]) -> None:
        self._last[name] = Told(sample.message, sample.at)

    def _scanned(self, sample: Sample[LaserScan]) -> None:
        self._keep("scan", sample)
        scan = sample.message
        pose = self._ground.see(scan)
        camera = self._ground.camera
        self._offer("scene", Once(lambda: scene(scan, pose, camera)))
        image = next((each for each in tuple(self._images) if each.fields.get("stamp") == scan.stamp), None)
        if image is not None:
            self._offer("depth", Once(lambda: depth_picture(image.message, scan)))
        self._offer("ground", self._make_ground)

    def _pictured(self, sample: Sample[DepthImage]) -> None:
        if "stamp" in sample.fields:  # what is no image must not wait for a scan
            self._images.append(sample)
        age = self._age("scan", time.monotonic())
        if age is None or age > SCANLESS:
            self._offer("depth", Once(lambda: depth_picture(sample.message, None)))

    def _moved(self, sample: Sample[Odometry]) -> None:
        self._keep("odometry", sample)
        self._ground.move(sample.message)

    def _felt(self, sample: Sample[BaseState]) -> None:
        self._keep("base", sample)
        self._ground.feel(sample.message)

    def _decided(self, sample: Sample[SafetyState]) -> None:
        before = self._last.get("safety")
        self._keep("safety", sample)
        if before is None or before.message.rule != sample.message.rule:
            for looker in self._lookers:
                looker.refresh()
        self._offer("ground", self._make_ground)

    def _described(self, sample: Sample[RobotDescription]) -> None:
        self._ground.describe(sample.message)

    def _mapped(self, sample: Sample[OccupancyGrid]) -> None:
        grid, name = sample.message, sample.path.removeprefix(topics.MAP.path).strip("/")
        self._maps[name] = make = Once(lambda: map_picture(name, grid))
        self._offer(f"map {name}", make)

    def _located(self, sample: Sample[Pose2D]) -> None:
        self._poses[sample.path.removeprefix(topics.POSE.path).strip("/")] = sample.message

    def _make_ground(self) -> bytes | None:
        window = self._ground.cells()
        if window is None:
            return None
        last = self._last.get("safety")
        met = self._ground.obstruction(last.message) if last else None
        header = {
            "kind": "ground",
            "x": window.x,
            "y": window.y,
            "rows": window.cells.shape[0],
            "columns": window.cells.shape[1],
            "obstruction": met._asdict() if met else None,
        }
        return packet(header, {"cells": window.cells})

    def _age(self, name: str, now: float) -> float | None:
        told = self._last.get(name)
        return now - told.at if told else None

    def _with_age(self, name: str, now: float, words: Callable[[Any], dict[str, object]]) -> dict[str, object] | None:
        told = self._last.get(name)
        return {**words(told.message), "age": now - told.at} if told else None


def _safety(state: SafetyState) -> dict[str, object]:
    return {
        "rule": state.rule,
        **why(state)._asdict(),
        "distance": state.distance,
        "asked": state.asked,
        "allowed": state.allowed,
        "latched": state.latched,
    }


def _base(state: BaseState) -> dict[str, object]:
    return {
        "felt": felt(state),
        "cliffs": state.cliffs,
        "bumpers": state.bumpers,
        "voltage": state.battery_voltage,
        "percent": state.battery_percent,
        "charger": state.charger,
    }


def _odometry(odometry: Odometry) -> dict[str, object]:
    return {"pose": odometry.pose, "twist": odometry.twist}


def _service(health: Health) -> dict[str, object]:
    status = health.status
    return {
        "name": health.name,
        "state": health.state,
        "rate": status.rate if status else None,
        "latency": health.latency if status else None,
        "notes": health.notes,
    }
