"""Whether the router that a router has joined lets anything pass.

Where a router is joined by two links at a time, Zenoh now and then sends the first word of who it is on one link before
the other end is ready for it, or looks for the other's certificate before it has one. Then one takes the other for
nobody, and refuses all that it sends, without a word and for as long as the links last. The other's tokens may arrive
all the same, so only an answer to a question tells that both ways are open.
"""

from collections.abc import Collection

PATIENCE = 3  # looks, a second apart, in which a router that lets us pass has shown itself
TRIES = 3  # sessions that are opened anew until one has; each costs frames, and there may be none that shows itself


class Joined:
    """Looks from one session to the next."""

    def __init__(self, own: str) -> None:
        """own: the key of this router's token."""
        self._own = own
        self._looks, self._tries = 0, TRIES

    def is_shut(self, linked: bool, routers: Collection[str]) -> bool:
        """Look once a second: whether a session of its own is worth opening, for nothing passes though it is linked.

        routers: the keys of tokens that a question for them brought; the other router may be of another robot.
        """
        others = [each for each in routers if each != self._own]
        if others:
            self._tries = TRIES
        self._looks = self._looks + 1 if linked and not others else 0
        shut = self._looks >= PATIENCE and self._tries > 0
        if shut:
            self._looks, self._tries = 0, self._tries - 1
        return shut
