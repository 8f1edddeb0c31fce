"""Getting to know the base: it reports its firmware before anything moves."""

import logging
import math

from cliffscan.common.runtime.command_handlers import Answer, done, failed
from cliffscan.services.kobuki.protocol import commands
from cliffscan.services.kobuki.protocol.packets import Feedback
from cliffscan.services.kobuki.protocol.sensors import Udid
from cliffscan.services.kobuki.protocol.versions import Version, advice, refusal

AGAIN = 0.5  # [s] between two requests

log = logging.getLogger(__name__)


class Handshake:
    """What the base has reported of itself. Nothing is written before it has sent something."""

    def __init__(self) -> None:
        self.firmware: Version | None = None
        self.hardware: Version | None = None
        self.udid: Udid | None = None
        self.refused = ""  # why the base must not be driven
        self._asked_at = -math.inf

    @property
    def accepted(self) -> bool:
        """Whether the base may be driven."""
        return self.firmware is not None and not self.refused

    def receive(self, feedback: Feedback) -> bool:
        """Take in a packet; true for the one that brought the firmware."""
        self.hardware = feedback.hardware or self.hardware
        self.udid = feedback.udid or self.udid
        if feedback.firmware is None or self.firmware is not None:
            return False
        self.firmware = feedback.firmware
        self.refused = refusal(self.firmware, self.hardware) or ""
        counsel = advice(self.firmware, self.hardware)
        if counsel and not self.refused:
            log.warning(counsel)
        return True

    def request(self, now: float) -> bytes:
        """What to send now to learn more, if anything; `now` [s]."""
        if self.firmware is not None or now - self._asked_at < AGAIN:
            return b""
        self._asked_at = now
        return commands.request_versions()

    def answer(self) -> Answer:
        """What the base reported of itself, as an answer."""
        if self.firmware is None:
            return failed("the base has not reported its version")
        names = {"firmware": self.firmware, "hardware": self.hardware, "udid": self.udid}
        return done(self.refused or "may be driven", **{key: str(value) for key, value in names.items() if value})
