"""Messages for people: one line of JSON, long arrays put in a few words."""

import json
import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cliffscan.common.contract.message import Message


def line(message: Message, full: bool = False) -> str:
    """The message as JSON; arrays and bytes in words, or `full`y."""
    fields = {name: getattr(message, name) for name in type(message).model_fields}
    return json.dumps(fields, default=_whole if full else _words, ensure_ascii=False)


def _whole(value: Any) -> object:  # noqa: ANN401 - whatever JSON does not know
    return [_number(each) for each in value.tolist()] if isinstance(value, np.ndarray) else value.hex()


def _number(value: float) -> float | str | None:
    """JSON has neither: a free beam is "inf", one that was not seen null."""
    if math.isnan(value):
        return None
    return value if math.isfinite(value) else "inf"


def _words(value: Any) -> str:  # noqa: ANN401
    return _in_words(value) if isinstance(value, np.ndarray) else f"{len(value)} bytes"


def _in_words(values: NDArray[Any]) -> str:
    numbers = values[np.isfinite(values)]
    words = f"{numbers.size} numbers"
    if numbers.size:
        words += f" from {numbers.min():.3f} to {numbers.max():.3f}"
    free, unseen = int(np.isposinf(values).sum()), int(np.isnan(values).sum())
    return words + (f", {free} inf" if free else "") + (f", {unseen} nan" if unseen else "")
