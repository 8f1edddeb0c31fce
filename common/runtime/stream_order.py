"""Whether a stream of stamped samples is still the one camera it was."""

from typing import NamedTuple


class Oddity(NamedTuple):
    """What is odd about a sample's place in its stream."""

    what: str
    why: str


class StreamOrder:
    """Watches the stamps and sequence numbers of one key.

    A sample older than its predecessor, or with a lower sequence number, is no fault of the sample: a frame is seen as
    it is, whatever came before. But it tells of a clock set back, a restarted camera, or two cameras on one key.
    """

    def __init__(self) -> None:
        self._seq = -1
        self._stamp = -1

    def check(self, seq: int, stamp: int) -> Oddity | None:
        """What is odd about the next sample, if anything."""
        last_seq, last_stamp = self._seq, self._stamp
        self._seq, self._stamp = seq, stamp
        if stamp < last_stamp:
            return Oddity("stamp_back", f"stamp {stamp} comes {last_stamp - stamp} ns before the last one")
        if seq < last_seq:
            why = f"sequence number {seq} after {last_seq}: the camera restarted, or two cameras share this key"
            return Oddity("sequence_back", why)
        return None
