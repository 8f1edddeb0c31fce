"""The thread that sends to one viewer."""

import logging
from collections.abc import Callable

from websockets.exceptions import ConnectionClosed

from cliffscan.common.contract.message import MessageError
from cliffscan.services.ros2.cdr import CdrError
from cliffscan.view.outbox import Outbox, Sent

Send = Callable[[int, bytes], object]

log = logging.getLogger(__name__)


def send_all(outbox: Outbox, send: Send) -> None:
    """Send each message with its number until outbox or connection is closed; what goes wrong costs that one alone."""
    while sent := outbox.take():
        try:
            went = _send(sent, send)
        except ConnectionClosed:
            return
        if not went:
            outbox.acknowledge(sent.number)  # the viewer cannot


def _send(sent: Sent, send: Send) -> bool:
    """Make a message and send it; whether there was one. Raises ConnectionClosed."""
    try:
        body = sent.make()
        if body is not None:
            send(sent.number, body)
            return True
    except (MessageError, CdrError):  # it is decoded and converted only now
        pass
    except ConnectionClosed:
        raise
    except Exception:
        log.exception("a message for a viewer: an error of the program")
    return False
