"""Requests are taken in and answered: the thread that asks waits, the one that does everything works.

An answer is a map with `ok`, a `message` for people, and the values that were asked for.
"""

from collections.abc import Callable, Iterable
from concurrent.futures import Future
from typing import Any

from pydantic import BaseModel, ConfigDict, ValidationError

from cliffscan.common.contract.message import explain
from cliffscan.services.kobuki.port import PortLost
from cliffscan.services.kobuki.protocol import commands
from cliffscan.services.kobuki.protocol.sensors import Gains, GainSet

Answer = dict[str, Any]
Reply = Callable[[Answer], Answer | Future[Answer]]  # a later answer is a future
PATIENCE = 1.0  # [s] for an answer


class Request(BaseModel):
    """A request's parameters: strict; what nobody knows is passed over."""

    model_config = ConfigDict(strict=True, frozen=True, extra="ignore", allow_inf_nan=False)


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


def done(message: str, **values: object) -> Answer:
    """It was done, or is being done."""
    return {"ok": True, "message": message, **values}


def failed(why: str) -> Answer:
    """It was not done."""
    return {"ok": False, "message": why}


def unknown_command(names: Iterable[str]) -> Callable[[Answer], Answer]:
    """What answers requests that have none of these names."""
    answer = failed(f"no such command; there are {', '.join(names)}")
    return lambda _: answer


class CommandHandler:
    """Answers one kind of request, called from any thread; `reply` is called from the one that does the jobs."""

    def __init__(self, put: Callable[[Callable[[], None]], None], reply: Reply) -> None:
        self._put = put
        self._reply = reply

    def __call__(self, parameters: Answer) -> Answer:
        """The answer to a request with these parameters."""
        promised: Future[Answer | Future[Answer]] = Future()
        self._put(lambda: promised.set_result(self._answer(parameters)))
        try:
            answer = promised.result(PATIENCE)
            return answer.result(PATIENCE) if isinstance(answer, Future) else answer
        except TimeoutError:
            return failed(f"no answer within {PATIENCE:g} s")

    def _answer(self, parameters: Answer) -> Answer | Future[Answer]:
        try:
            return self._reply(parameters)
        except ValidationError as error:
            return failed(explain(error))
        except (ValueError, PortLost) as error:
            return failed(str(error))


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
