"""How much the clocks of services differ, from the stamps of their statuses."""

from collections import deque

from cliffscan.common.runtime.config import BASES

KEPT = 10  # statuses of each service: a clock that is set is followed in as many seconds
TOLERATED = 0.05  # [s] by which clocks may differ: less cannot be distinguished from the network's delays
REFERENCES = ("capture", *BASES)  # the services on the robot, by whose clock the frames are stamped


class Clocks:
    """The offset of each service's clock against the local one: the smallest way that one of its last statuses took.

    A status that was sent at `stamp` and came at `arrival` has taken arrival - stamp: its way, never negative, and what
    the local clock is ahead of the service's. The quickest way is the best estimate; between two services the local
    clock cancels out.
    """

    def __init__(self) -> None:
        self._ways: dict[str, deque[int]] = {}  # [ns]

    def receive(self, service: str, stamp: int, arrival: int) -> None:
        """A status was stamped by the service's clock and came by the local clock, both [ns]."""
        self._ways.setdefault(service, deque(maxlen=KEPT)).append(arrival - stamp)

    def reference(self) -> str:
        """The service on the robot whose clock is taken for the robot's; empty where none was received."""
        return next((name for name in REFERENCES if name in self._ways), "")

    def ahead(self, service: str) -> float:
        """How much the service's clock is ahead of the robot's [s]; 0 within what is TOLERATED, or not known."""
        robot = self.reference()
        if not robot or service not in self._ways:
            return 0.0
        ahead = (min(self._ways[robot]) - min(self._ways[service])) * 1e-9
        return ahead if abs(ahead) > TOLERATED else 0.0
