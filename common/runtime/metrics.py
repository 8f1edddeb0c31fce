"""What a service counts and warns of: every event is counted, its log line comes at a limited rate."""

import logging
import threading
import time
from collections import Counter, deque

import numpy as np

LOG_INTERVAL = 1.0  # [s] between two log lines of one kind
WINDOW = 300  # outputs over which latencies are reported

log = logging.getLogger(__name__)


class ServiceMetrics:
    """Counts, warnings and latencies of one service; safe to use from any thread."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._counts: Counter[str] = Counter()
        self._logged: dict[str, float] = {}
        self._latencies: deque[float] = deque(maxlen=WINDOW)
        self._outputs = 0

    def count(self, what: str, by: int = 1) -> None:
        """Add to a count."""
        with self._lock:
            self._counts[what] += by

    def warn_limited(self, what: str, why: str) -> None:
        """Count `what` and log why, unless a line of that kind came within the last second."""
        now = time.monotonic()
        with self._lock:
            self._counts[what] += 1
            count = self._counts[what]
            silent = now - self._logged.get(what, -LOG_INTERVAL) < LOG_INTERVAL
            if not silent:
                self._logged[what] = now
        if not silent:
            log.warning("%s (%d so far): %s", what, count, why)

    def output(self, stamp: int) -> None:
        """Count one main output of a capture at `stamp` [ns] as `published`."""
        latency = (time.time_ns() - stamp) * 1e-9
        with self._lock:
            self._counts["published"] += 1
            self._outputs += 1
            self._latencies.append(latency)

    def counts(self) -> dict[str, int]:
        """A copy of all counts."""
        with self._lock:
            return dict(self._counts)

    def take_outputs(self) -> int:
        """Main outputs since this was last asked."""
        with self._lock:
            outputs, self._outputs = self._outputs, 0
            return outputs

    def latency(self) -> tuple[float, float]:
        """Median and 99th percentile [s] from capture to output; 0 before the first."""
        with self._lock:
            recent = list(self._latencies)
        if not recent:
            return 0.0, 0.0
        median, worst = np.percentile(recent, (50, 99))
        return float(median), float(worst)
