"""A router that was there comes again, however its keys are copied."""

from contextlib import nullcontext

import pytest

from cliffscan import router
from cliffscan.common.runtime.network import BusError, Network
from cliffscan.router import route
from tests import build


@pytest.fixture
def sessions(monkeypatch):
    """What comes of each attempt to open a session; at the end the process is told to end."""
    sessions = []

    def connect(*_):
        found = sessions.pop(0) if sessions else None
        if isinstance(found, Exception):
            raise found
        return found

    monkeypatch.setattr(router, "connect", connect)
    monkeypatch.setattr(router, "_route_once", lambda *_: None)
    monkeypatch.setattr(router, "Service", lambda *_: None)
    monkeypatch.setattr(router, "RETRY", 0.0)
    return sessions


def test_keys_that_are_half_copied_are_waited_for(sessions, caplog):
    sessions += [nullcontext(), *[BusError("cert.pem: is no certificate")] * 3, nullcontext()]
    assert route(Network("router"), "r", "here", build.Stop()) == 0
    assert not sessions
    assert caplog.text.count("waits for the rest of the keys, for cert.pem: is no certificate") == 1


def test_keys_that_are_wrong_at_first_end_it(sessions):
    sessions.append(BusError("cert.pem: is no certificate"))
    with pytest.raises(BusError):
        route(Network("router"), "r", "here", build.Stop())
