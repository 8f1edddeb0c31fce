"""The way from the base to the driver, and what can happen to bytes on it."""

import math
import random


class Line:
    """Carries what the base says; on demand with garbage, flipped bits, cuts and silence.

    The same seed gives the same faults.
    """

    def __init__(self, seed: int = 0) -> None:
        self._random = random.Random(seed)
        self._held = b""
        self._size = 0
        self._garbage = 0
        self._corrupt = 0
        self._silence = 0.0
        self._repeats = False
        self._rate = self._room = 0.0  # [bytes/s], [bytes]
        self._last = b""

    def garbage(self, count: int) -> None:
        """Send some random bytes ahead of what the base says next."""
        self._garbage += count

    def corrupt(self, count: int) -> None:
        """Flip one bit in each of the next packets."""
        self._corrupt += count

    def cut(self, size: int) -> None:
        """Hand over the stream in pieces of this many bytes, whatever is whole then; 0: as it comes."""
        self._size = size

    def repeat(self, on: bool) -> None:
        """Hand over the last packet again and again, in the place of each new one."""
        self._repeats = on

    def pause(self, seconds: float) -> None:
        """Lose what the base says in the next seconds."""
        self._silence = max(self._silence, seconds)

    def slow(self, rate: float) -> None:
        """Carry what a driver says at so many bytes in a second; 0: at once. Raises ValueError."""
        if not 0.0 <= rate < math.inf:
            raise ValueError(f"{rate} bytes in a second, expected 0 or more")
        self._rate, self._room = rate, 0.0

    def room(self, dt: float) -> int | None:
        """How many bytes of a driver's arrive in the next `dt` [s]; None for as many as there are."""
        if not self._rate:
            return None
        self._room = min(self._room + self._rate * dt, self._rate)
        room = int(self._room)
        self._room -= room
        return room

    def carry(self, said: bytes, dt: float) -> list[bytes]:
        """What arrives, piece by piece, of what was said during the last `dt` [s]."""
        silent, self._silence = self._silence > 0.0, max(0.0, self._silence - dt)
        if silent:
            return []
        if said:
            said = self._last = self._last if self._repeats and self._last else said
        if said and self._corrupt > 0:
            self._corrupt -= 1
            said = self._flipped(said)
        noise, self._garbage = self._random.randbytes(self._garbage), 0
        self._held += noise + said
        return self._pieces()

    def _flipped(self, said: bytes) -> bytes:
        place = self._random.randrange(len(said))
        return said[:place] + bytes([said[place] ^ 1 << self._random.randrange(8)]) + said[place + 1 :]

    def _pieces(self) -> list[bytes]:
        size = self._size or len(self._held)
        whole = len(self._held) - len(self._held) % size if size else 0
        pieces = [self._held[start : start + size] for start in range(0, whole, size)] if whole else []
        self._held = self._held[whole:]
        return pieces
