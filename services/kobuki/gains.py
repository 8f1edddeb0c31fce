"""The gains of the base's wheel controller, set and reported on request."""

from collections.abc import Callable
from concurrent.futures import Future

from cliffscan.common.runtime.command_handlers import Answer, Request, done
from cliffscan.services.kobuki.protocol import commands
from cliffscan.services.kobuki.protocol.sensors import Gains, GainSet


class GainsRequest(Request):
    """Nothing to ask for the gains; `factory`, or `p`, `i` and `d`, to set them."""

    factory: bool = False
    p: float | None = None
    i: float | None = None
    d: float | None = None

    def gains(self) -> Gains | None:
        """The gains to set. Raises ValueError where some are missing."""
        given = [value for value in (self.p, self.i, self.d) if value is not None]
        if self.factory:
            return Gains(GainSet.FACTORY, 0.0, 0.0, 0.0)
        if not given:
            return None
        if len(given) < len("pid"):
            raise ValueError("expected p, i and d together")
        return Gains(GainSet.USER, *given)


class GainsHandler:
    """Sets and reports the wheel controller's gains; the base sends them with a later packet."""

    def __init__(self, write: Callable[[bytes], None]) -> None:
        self._write = write
        self._promised: list[Future[Answer]] = []

    def request(self, parameters: Answer) -> Future[Answer]:
        """Set the gains, if some are given, and ask for them."""
        gains = GainsRequest.model_validate(parameters).gains()
        if gains:
            self._write(commands.set_gains(gains))
        self._write(commands.get_gains())
        self._promised.append(Future())
        return self._promised[-1]

    def receive(self, gains: Gains) -> None:
        """The base sent its gains."""
        answer = done(f"{gains.kind.name.lower()} gains", p=gains.p, i=gains.i, d=gains.d)
        for promise in self._promised:
            promise.set_result(answer)
        self._promised.clear()
