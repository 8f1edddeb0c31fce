"""Requests are taken in and answered: the thread that asks waits, the one that does everything works.

An answer is a map with `ok`, a `message` for people, and the values that were asked for.
"""

from collections.abc import Callable, Iterable
from concurrent.futures import Future
from typing import Any

from pydantic import BaseModel, ConfigDict, ValidationError

from cliffscan.common.contract.message import explain

Answer = dict[str, Any]
Reply = Callable[[Answer], Answer | Future[Answer]]  # a later answer is a future
PATIENCE = 1.0  # [s] for an answer


class Request(BaseModel):
    """A request's parameters: strict; what nobody knows is passed over."""

    model_config = ConfigDict(strict=True, frozen=True, extra="ignore", allow_inf_nan=False)


class CannotDo(Exception):
    """What is asked for cannot be done now; one line with the remedy."""


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
        except (ValueError, CannotDo) as error:
            return failed(str(error))
