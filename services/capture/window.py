"""Which frames go, and how large, by how soon those before them were answered with a scan.

A queue that stands in a link makes every scan late and none newer. So while earlier frames wait for their answers, the
next one is not sent: the newest goes as soon as there is room. Where answers stay late all the same, frames become
smaller. Now and then one full frame goes along: its answer shows whether the link carries them again.
"""

import math
import threading
from collections import deque
from enum import Enum
from typing import NamedTuple

SILENCE = 2.0  # [s] without an answer after which nobody is there to answer
LOST = 0.4  # [s] after which a frame will not be answered
SMOOTH = 0.25  # share of the newest answer in the delay
LATE = 0.14  # [s] delay beyond which fewer frames may wait for their answers, and up to which more
STEP = 0.1  # frames fewer or more with each answer
FILLED, FEW = 0.1, 3  # [s] of frames, and frames at least, that may wait where answers come soon
TOO_LATE = 0.09  # [s] delay beyond which frames become smaller
SETTLING = 0.5  # [s] in which a change shows
SPARE = 0.35  # of the time between two frames, which a full one may take longer than a thin one
PROVEN = 3  # full frames in a row that the link must carry so
FIRST_TRY, LONGEST_TRY, LONGER = 2.0, 60.0, 4.0  # [s] between tries, and by how much more after one that failed


class Size(Enum):
    """How much of a frame goes."""

    FULL = "all of it"
    THIN = "what matters, and half of the columns"


class Flying(NamedTuple):
    """A frame that has not been answered."""

    seq: int
    sent: float  # [s]
    size: Size


class Window:
    """Times are the caller's [s], on any clock that does not go back. period [s]: between two frames.

    Safe to use from any thread. As long as nobody answers, every frame goes, and all of it.
    """

    def __init__(self, period: float) -> None:
        self.size = Size.FULL
        self._spare = SPARE * period
        self._most = max(FEW, round(FILLED / period))
        self._room = float(self._most)  # how many frames may wait for their answers
        self._lock = threading.Lock()
        self._flying: deque[Flying] = deque(maxlen=2 * self._most)
        self._answered = -math.inf  # when the last answer came
        self._delay = 0.0  # [s] from a frame to its answer, smoothed; of full frames, or of thin ones
        self._changed = -math.inf  # when the size did
        self._try_at, self._pause = math.inf, FIRST_TRY
        self._carried = 0  # full frames in a row that came through well

    def admit(self, seq: int, now: float) -> Size | None:
        """How much of the frame is to be sent now; None where it is to be held back."""
        with self._lock:
            if now - self._answered > SILENCE:
                self._flying.append(Flying(seq, now, Size.FULL))
                return Size.FULL
            while self._flying and now - self._flying[0].sent > LOST:
                self._late(self._flying.popleft(), LOST, now)
            if len(self._flying) >= int(self._room):
                return None
            size = self._next_size(now)
            self._flying.append(Flying(seq, now, size))
            return size

    def answer(self, seq: int, now: float) -> None:
        """The scan of a frame came."""
        with self._lock:
            self._answered = now
            if not any(frame.seq == seq for frame in self._flying):
                return
            while (frame := self._flying.popleft()).seq != seq:
                pass  # it was overtaken, or lost
            self._late(frame, now - frame.sent, now)

    def _next_size(self, now: float) -> Size:
        if self.size is Size.THIN and now >= self._try_at:
            self._try_at = math.inf  # until that one is answered
            return Size.FULL
        return self.size

    def _late(self, frame: Flying, delay: float, now: float) -> None:
        """A frame was answered after `delay` [s], or will not be."""
        if frame.size is not self.size:
            if self.size is Size.THIN:
                self._judge_try(delay, now)
            return
        self._delay += SMOOTH * (delay - self._delay)
        self._room += STEP if self._delay <= LATE else -STEP
        self._room = min(max(self._room, 1.0), self._most)
        if self.size is Size.FULL and self._delay > TOO_LATE and now - self._changed > SETTLING:
            lasted = now - self._changed > LONGEST_TRY
            self._pause = FIRST_TRY if lasted else min(self._pause * LONGER, LONGEST_TRY)
            self._change(Size.THIN, now)
            self._try_at = now + self._pause

    def _judge_try(self, delay: float, now: float) -> None:
        """Whether the link carried a full frame while thin ones go."""
        well = delay - self._delay <= self._spare
        self._carried = self._carried + 1 if well else 0
        if self._carried >= PROVEN:
            self._change(Size.FULL, now)
            return
        self._pause = FIRST_TRY if well else min(self._pause * LONGER, LONGEST_TRY)
        self._try_at = now + self._pause

    def _change(self, size: Size, now: float) -> None:
        self.size, self._changed, self._carried = size, now, 0
        self._delay = min(self._delay, TOO_LATE)  # what is known is of the other size
