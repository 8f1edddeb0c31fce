"""From a payload to a message, with what a service counts and says of it."""

from typing import Generic, TypeVar

from cliffscan.common.contract.message import Message, MessageError
from cliffscan.common.contract.messages import DepthImage, LaserScan
from cliffscan.common.runtime.metrics import ServiceMetrics
from cliffscan.common.runtime.stream_order import StreamOrder

M = TypeVar("M", bound=Message)


class Decoder(Generic[M]):
    """Decodes the payloads of one stream of `kind`; the first of `metrics` warns, all of them count."""

    def __init__(self, kind: type[M], *metrics: ServiceMetrics) -> None:
        self._kind = kind
        self._warner, *self._counters = metrics
        self._order = StreamOrder()

    def decode(self, path: str, payload: bytes) -> M | None:
        """The message that came at `path`; None where it is malformed."""
        try:
            message = self._kind.decode(payload)
        except MessageError as error:
            self.refused(path, error)
            return None
        oddity = self._order.check(message.seq, message.stamp) if isinstance(message, DepthImage | LaserScan) else None
        if oddity:
            self._warn(oddity.what, f"{path}: {oddity.why}")
        self.count("received")
        return message

    def refused(self, path: str, why: MessageError) -> None:
        """A payload at `path` was malformed."""
        self._warn("malformed", f"{path}: {why}")

    def count(self, what: str) -> None:
        """Add one to a count."""
        for metrics in (self._warner, *self._counters):
            metrics.count(what)

    def _warn(self, what: str, why: str) -> None:
        self._warner.warn_limited(what, why)
        for metrics in self._counters:
            metrics.count(what)
