"""The robots on the network, and the views of those that somebody looks at."""

import threading
from collections.abc import Callable

from cliffscan.common.contract.message import MessageError
from cliffscan.common.contract.topics import command
from cliffscan.common.runtime.bus import Bus
from cliffscan.common.runtime.reader import guarded
from cliffscan.common.runtime.stop_signal import StopSignal
from cliffscan.view.robot_view import RobotView
from cliffscan.view.words import notice

TURN = 0.5  # [s] between two looks
LOOK = 0.3  # [s] in which a network answers that has no robot
ANSWER_WITHIN = 1.0  # [s]
ASKED = ("stop", "clear_safety")  # of the base's commands, those that the page has a button for


class Robots:
    """Looks at the network while somebody looks at the page. Without a bus yet, nothing is there."""

    def __init__(self, preferred: str, where: str) -> None:
        self.preferred = preferred
        self._where = where
        self._bus: Bus | None = None
        self._attached = threading.Event()
        self._views: dict[str, RobotView] = {}
        self._names: list[str] = []
        self._lock = threading.Lock()
        self._lookers: list[Callable[[], None]] = []
        self._looked_at = threading.Event()

    def attach(self, bus: Bus) -> None:
        """The network is there."""
        self._bus = bus
        self._attached.set()

    def view(self, robot: str, patience: float = 0.0) -> RobotView | None:
        """The view of a robot; None where there is no network within `patience` [s]."""
        self._attached.wait(patience)
        with self._lock:
            if self._bus is None:
                return None
            return self._views.setdefault(robot, RobotView(self._bus, robot))

    def ask(self, robot: str, name: str) -> str:
        """Have a robot's base do one of ASKED; what became of it, in words."""
        if self._bus is None:
            return f"{name}: no router answers"
        try:
            reply = self._bus.beside(robot).ask(command(name), {}, ANSWER_WITHIN)
        except MessageError as error:
            return f"{name}: malformed reply: {error}"
        if reply is None:
            return f"{name}: NO ANSWER from the base of {robot}"
        return f"{name}: {'done' if reply.get('ok') is True else 'REFUSED'}, {reply.get('message', '')}"

    def state(self, view: RobotView | None, robot: str) -> dict[str, object]:
        """What the page says of the network."""
        connected = self._bus is not None and self._bus.connected
        found = view is not None and view.found
        others = [name for name in self._names if name != robot]
        return {
            "kind": "state",
            "robot": robot,
            "robots": sorted({*self._names, robot}),
            "connected": connected,
            "found": found,
            "notice": notice(connected, found, robot, others, self._where),
        }

    def watch(self, look: Callable[[], None]) -> Callable[[], None]:
        """Call `look` every TURN until what is returned is called."""
        with self._lock:
            self._lookers = [*self._lookers, look]
            self._looked_at.set()

        def leave() -> None:
            with self._lock:
                self._lookers = [each for each in self._lookers if each is not look]
                if not self._lookers:
                    self._looked_at.clear()

        return leave

    def run(self, stop: StopSignal) -> None:
        """Look, while anybody does, until asked to end."""
        while not stop.is_set():
            if self._looked_at.wait(TURN):
                guarded("the robots", self._look)
                stop.wait(TURN)

    def _look(self) -> None:
        if self._bus is not None and self._bus.connected:
            self._names = sorted(self._bus.robots(LOOK))
            for view in list(self._views.values()):
                guarded(f"robot {view.robot}", view.examine)
        else:
            self._names = []
        for look in self._lookers:
            guarded("a viewer", look)
