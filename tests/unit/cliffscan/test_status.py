"""What the table says of services that are there, gone, silent, fed by nobody, or malicious."""

import io
import time

import pytest
from rich.console import Console

from cliffscan.clocks import Clocks
from cliffscan.common.contract.messages import ServiceStatus
from cliffscan.common.runtime.config import SERVICES
from cliffscan.health import LastStatus, examine
from cliffscan.status import picture

NOW = 100.0


def told(service, **changes):
    fields = {"stamp": time.time_ns(), "service": service, "version": "1", "state": "working", "pid": 1}
    fields |= {"uptime": 60.0, "rate": 30.0, "latency": (0.05, 0.09), "counts": {}, "note": ""}
    return ServiceStatus(**(fields | changes))


def heard(age=0.5, **changes):
    """All services as they should be, but for those with `changes`; None: not there at all."""
    last = {
        name: LastStatus(told(name, **changes.get(name, {})), NOW - age) for name in SERVICES if name not in changes
    }
    odd = {name: fields for name, fields in changes.items() if fields is not None}
    return last | {name: LastStatus(told(name, **fields), NOW - age) for name, fields in odd.items()}


def notes(last, alive=None, clocks=None):
    healths = examine(set(last) if alive is None else alive, last, clocks or Clocks(), NOW)
    return {health.name: " | ".join(health.notes) for health in healths if health.notes}


def shown(robot, healths):
    text = io.StringIO()
    Console(file=text, width=80, force_terminal=True, color_system=None).print(picture(robot, healths))
    return text.getvalue()


def test_where_all_is_well_nothing_is_noted():
    assert notes(heard()) == {}


def test_what_should_be_there_and_is_not_heard_is_named():
    last = heard(capture=None, kobuki=None)
    text = shown("turtlebot", examine(set(last), last, Clocks(), NOW))
    assert "not found: capture, kobuki: where they run, does its router join this one" in " ".join(text.split())
    assert max(map(len, text.splitlines())) <= 80


@pytest.mark.parametrize(
    ("changes", "service", "note"),
    [
        ({"capture": None, "negative": {"rate": 0.0}}, "negative", "no depth frame arrives: capture is not there"),
        ({"capture": {"rate": 0.0}}, "capture", "no frame comes from its source"),
        (
            {"capture": {"rate": 0.0}, "positive": {"rate": 0.0}},
            "positive",
            "no depth frame arrives: capture publishes nothing",
        ),
        ({"positive": {"rate": 0.0}}, "positive", "no depth frame arrives, though capture publish"),
        (
            {"negative": {"rate": 0.0}, "fuse": {"rate": 0.0}},
            "fuse",
            "no pair of scans arrives: negative publishes nothing",
        ),
    ],
)
def test_a_service_that_receives_nothing_tells_where_the_chain_is_broken(changes, service, note):
    assert note in notes(heard(**changes))[service]


def test_a_service_that_has_just_started_may_have_received_nothing():
    assert "fuse" not in notes(heard(fuse={"rate": 0.0, "uptime": 1.0}))


def test_a_token_without_a_recent_status_is_noted():
    assert "no status for 4 s" in notes(heard(age=4.0))["fuse"]
    assert "no status of it comes" in notes(heard(fuse=None), alive=set(SERVICES))["fuse"]
    assert "router-vm" not in notes(heard(), alive={*SERVICES, "router-vm"})


def test_what_had_a_token_is_gone():
    last = heard()
    states = {health.name: health.state for health in examine(set(SERVICES) - {"fuse"}, last, Clocks(), NOW)}
    assert states["fuse"] == "gone"
    assert states["negative"] == "working"


def test_latencies_are_by_the_robots_clock():
    clocks = Clocks()
    for service, stamp in (("capture", 0), ("kobuki", 0), ("fuse", 10 * 10**9)):
        clocks.receive(service, stamp + 10**12, 10**12)
    last = heard(fuse={"latency": (10.05, 10.09)})
    fuse = next(health for health in examine(set(last), last, clocks, NOW) if health.name == "fuse")
    assert fuse.latency == pytest.approx((0.05, 0.09))
    assert notes(last, clocks=clocks) == {
        "fuse": "its clock is 10.00 s ahead of that of capture: synchronise them (chrony)"
    }


def test_no_text_of_others_is_markup_or_reaches_the_terminal_as_a_command():
    last = heard(fuse={"note": "[/x] [bold]\x1b[2J\u202e", "counts": {"[/y]\x1b": 3}})
    last["[/z]"] = LastStatus(told("[/z]"), NOW)
    text = shown("turtlebot", examine(set(last), last, Clocks(), NOW))
    assert "[/x] [bold]\\u001b[2J\\u202e" in text
    assert "[/y]\\u001b" in text
    assert "[/z]" in text
    assert all(each.isprintable() or each == "\n" for each in text)
