"""Which frames go, and how large, by how soon those before them were answered with a scan.

A queue that stands in a link makes every scan late and none newer. So while earlier frames wait for their answers, the
next one is not sent: the newest goes as soon as there is room. Where answers stay late all the same, frames become
smaller, by one size at a time. Now and then one frame of the next larger size goes along: its answer shows whether the
link carries those again.
"""

import math
import threading
from collections import deque
from enum import Enum
from typing import NamedTuple

SILENCE = 2.0  # [s] without an answer after which nobody is there to answer
SOONEST_LOST, LOST = 0.2, 0.4  # [s] after which a frame that was not answered counts as lost: twice the delay, of these
SMOOTH = 0.25  # share of the newest answer in the delay
LATE = 0.14  # [s] delay beyond which fewer frames may wait for their answers, and up to which more
WAITED = 0.08  # [s] more than the least delay, too; a link that is long is idle while one frame waits for its answer
CREEP = 1e-3  # [s] by which the least delay is taken to have grown with each answer
STEP = 0.1  # frames fewer or more with each answer
FILLED, FEW = 0.1, 3  # [s] of frames, and frames at least, that may wait where answers come soon
TOO_LATE = 0.09  # [s] delay beyond which frames become smaller
SETTLING = 0.5  # [s] in which a change shows
SPARE = 0.35  # of the time between two frames, which one of the next larger size may take longer
PROVEN = 3  # of these in a row, which the link must carry so
FIRST_TRY, LONGEST_TRY, LONGER = 2.0, 60.0, 4.0  # [s] between tries, and by how much more after one that failed


class Size(Enum):
    """How much of a frame goes, from all to least; its value: of how many columns one."""

    FULL = 1
    HALF = 2
    THIRD = 3


SMALLEST = Size.THIRD


class Flying(NamedTuple):
    """A frame that has not been answered."""

    seq: int
    sent: float  # [s]
    size: Size
    larger: bool = False  # than the others, to try the link


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
        self._delay = 0.0  # [s] from a frame of this size to its answer, smoothed,
        self._spread = 0.0  # by how much these differ from it, smoothed,
        self._least = math.inf  # and the least of them, of late
        self._changed = -math.inf  # when the size did
        self._grown = False  # whether it became larger then
        self._try_at, self._pause = math.inf, FIRST_TRY
        self._carried = 0  # larger frames in a row that came through well

    def admit(self, seq: int, now: float) -> Size | None:
        """How much of the frame is to be sent now; None where it is to be held back."""
        with self._lock:
            if now - self._answered > SILENCE:
                self._try_at = min(self._try_at, now + self._pause)  # what was on its way tells nothing
                self._flying.append(Flying(seq, now, Size.FULL))
                return Size.FULL
            while self._flying and (waited := now - self._flying[0].sent) > self._patience:
                self._late(self._flying.popleft(), waited, now)
            if len(self._flying) >= int(self._room):
                return None
            frame = Flying(seq, now, self.size)
            if self.size is not Size.FULL and now >= self._try_at:
                self._try_at = math.inf  # until that one is answered
                frame = Flying(seq, now, self._next_larger(), larger=True)
            self._flying.append(frame)
            return frame.size

    def answer(self, seq: int, now: float) -> None:
        """The scan of a frame came."""
        with self._lock:
            self._answered = now
            if not any(frame.seq == seq for frame in self._flying):
                return
            while (frame := self._flying.popleft()).seq != seq:  # it was overtaken, or lost
                if frame.larger:
                    self._try_at = now + self._pause  # once more, for it tells nothing
            self._late(frame, now - frame.sent, now)

    @property
    def _patience(self) -> float:
        """After how long [s] a frame counts as lost.

        TCP finds out that what it sent again was lost, too, by what comes behind it: so something has to go there.
        """
        return min(max(SOONEST_LOST, 2.0 * self._delay), LOST)

    def _next_larger(self) -> Size:
        return Size(self.size.value - 1)

    def _late(self, frame: Flying, delay: float, now: float) -> None:
        """A frame was answered after `delay` [s], or will not be."""
        if frame.size is not self.size:
            if frame.larger and frame.size is self._next_larger():
                self._judge_try(delay, now)
            return
        self._spread += SMOOTH * (abs(delay - self._delay) - self._spread)
        self._delay += SMOOTH * (delay - self._delay)
        self._least = min(self._least + CREEP, delay)
        self._room += STEP if self._delay <= max(LATE, self._least + WAITED) else -STEP
        self._room = min(max(self._room, 1.0), self._most)
        if self.size is not SMALLEST and self._delay > TOO_LATE and now - self._changed > SETTLING:
            failed = self._grown and now - self._changed <= LONGEST_TRY
            self._pause = min(self._pause * LONGER, LONGEST_TRY) if failed else FIRST_TRY
            self._change(Size(self.size.value + 1), now, grown=False)

    def _judge_try(self, delay: float, now: float) -> None:
        """Whether the link carried a larger frame while smaller ones go."""
        well = delay - self._delay <= self._spare + self._spread
        self._carried = self._carried + 1 if well else 0
        if self._carried >= PROVEN:
            self._change(self._next_larger(), now, grown=True)
            return
        self._pause = FIRST_TRY if well else min(self._pause * LONGER, LONGEST_TRY)
        self._try_at = now + self._pause

    def _change(self, size: Size, now: float, *, grown: bool) -> None:
        self.size, self._changed, self._grown, self._carried = size, now, grown, 0
        self._delay, self._spread, self._least = min(self._delay, TOO_LATE), 0.0, math.inf  # those were of another size
        self._try_at = now + self._pause
