"""Whether the router that a router with keys has joined lets anything pass.

Where a router is joined by two links at a time, Zenoh now and then looks for the other's certificate before it has one:
then it takes the other for nobody, and refuses all that it sends, without a word and for as long as the links last.
"""

import threading

PATIENCE = 3  # looks, a second apart, in which a router that lets us pass has shown itself
TRIES = 3  # sessions that are opened anew until one has: there may be none that shows itself


class Joined:
    """Follows the tokens of the other routers, from one session to the next."""

    def __init__(self, own: str) -> None:
        """own: the name of this router's token."""
        self._own = own
        self._lock = threading.Lock()
        self._others: set[str] = set()
        self._looks, self._tries = 0, TRIES

    def begin(self) -> None:
        """A session was opened."""
        with self._lock:
            self._others.clear()
            self._looks = 0

    def changed(self, service: str, alive: bool) -> None:
        """A token came or went."""
        if service.startswith("router-") and service != self._own:
            with self._lock:
                (self._others.add if alive else self._others.discard)(service)

    def is_shut(self, linked: bool) -> bool:
        """Look once a second: whether a session of its own is worth opening, for nothing passes though it is linked."""
        with self._lock:
            if self._others:
                self._tries = TRIES
            self._looks = self._looks + 1 if linked and not self._others else 0
            shut = self._looks >= PATIENCE and self._tries > 0
            self._tries -= shut
            return shut
