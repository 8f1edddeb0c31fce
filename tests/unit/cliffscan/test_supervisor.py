"""Processes are kept running, given up where they refuse their configuration, and ended together."""

import os
import signal
import sys
import time

import pytest

from cliffscan import supervisor as module
from cliffscan.supervisor import Child, ConfigRefused, Supervisor

WORK = """
import signal
signal.pthread_sigmask(signal.SIG_BLOCK, [signal.SIGTERM])
{ready}
signal.sigwait([signal.SIGTERM])
"""
STUBBORN = "import signal; signal.alarm(20); signal.signal(signal.SIGTERM, signal.SIG_IGN); {ready}; signal.pause()"


@pytest.fixture(autouse=True)
def patience(monkeypatch):
    """A busy machine may need more than GRACE for a process that ends by itself."""
    monkeypatch.setattr(module, "GRACE", 60.0)


@pytest.fixture
def family():
    with Supervisor() as family:
        yield family


@pytest.fixture
def ready(tmp_path):
    """Python code that says that its process has come this far, and a function that waits for it."""
    pipe = tmp_path / "ready"
    os.mkfifo(pipe)
    return f"open({str(pipe)!r}, 'w').close()", pipe.read_bytes


def python(code):
    return [sys.executable, "-S", "-E", "-c", code]


def ended(pid):
    """Wait until a process is dead, and leave it for its parent to notice."""
    os.waitid(os.P_PID, pid, os.WEXITED | os.WNOWAIT)


def died(child, now):
    """Let a child that ends by itself be seen dead at `now`."""
    ended(child.pid)
    child.poll(now)


def test_a_child_that_works_is_left_alone(family, ready):
    code, wait = ready
    family.start("works", python(WORK.format(ready=code)))
    wait()
    child = family.children["works"]
    pid = child.pid
    family.poll()
    assert child.pid == pid


def test_a_finite_child_whose_work_is_done_is_not_started_again_and_that_is_said_once(caplog):
    caplog.set_level("INFO")
    child = Child("done", python("pass"), finite=True)
    pid = child.pid
    died(child, time.monotonic())
    child.poll(time.monotonic() + 100)
    assert child.pid == pid
    assert caplog.messages == ["done has done its work"]


def test_a_finite_child_that_failed_is_started_again(caplog):
    child, now = Child("failed", python("raise SystemExit(1)"), finite=True), time.monotonic()
    first = child.pid
    died(child, now)
    child.poll(now + 1)
    assert child.pid != first
    ended(child.pid)


def test_a_child_that_was_told_to_end_by_others_is_started_again_whatever_its_exit_code(family, ready, caplog):
    code, wait = ready
    family.start("works", python(WORK.format(ready=code)))
    wait()
    child = family.children["works"]
    first = child.pid
    os.kill(first, signal.SIGTERM)
    ended(first)
    family.poll()
    assert caplog.messages == ["works ended (exit 0); starting it again in 0.5 s"]
    child.poll(time.monotonic() + 1)
    wait()
    assert child.pid != first


def test_a_child_takes_the_place_of_one_of_its_name(family, ready):
    code, wait = ready
    family.start("works", python(WORK.format(ready=code)))
    wait()
    first = family.children["works"].pid
    family.start("works", python(WORK.format(ready=code)))
    wait()
    with pytest.raises(ProcessLookupError):
        os.kill(first, 0)
    assert family.children["works"].pid != first


def test_a_child_is_out_of_reach_of_the_terminals_signals(family, ready):
    code, wait = ready
    family.start("works", python(WORK.format(ready=code)))
    wait()
    assert os.getsid(family.children["works"].pid) != os.getsid(0)


def test_a_child_that_died_is_started_again_after_its_delay_and_that_is_said(caplog):
    child = Child("mortal", python("raise SystemExit(7)"))
    first, now = child.pid, time.monotonic()
    died(child, now)
    assert caplog.messages == ["mortal ended (exit 7); starting it again in 0.5 s"]
    child.poll(now + 0.49)
    assert child.pid == first
    child.poll(now + 0.5)
    assert child.pid != first
    ended(child.pid)


def test_a_child_that_was_killed_is_started_again(family, ready, caplog):
    code, wait = ready
    family.start("works", python(WORK.format(ready=code)))
    wait()
    child = family.children["works"]
    first = child.pid
    os.kill(first, signal.SIGKILL)
    ended(first)
    family.poll()
    assert "works ended (signal 9)" in caplog.text
    child.poll(time.monotonic() + 1)
    wait()
    assert child.pid != first


def test_a_child_that_dies_again_and_again_waits_longer_and_longer(caplog):
    child, now = Child("mortal", python("raise SystemExit(1)")), time.monotonic()
    for _ in range(6):
        died(child, now)
        now += 100.0 if "in 10 s" in caplog.messages[-1] else 10.0
        child.poll(now)
        now = time.monotonic()
    ended(child.pid)
    assert [message.split(" in ")[1] for message in caplog.messages] == ["0.5 s", "1 s", "2 s", "4 s", "8 s", "10 s"]


def test_a_child_that_worked_for_long_is_started_again_soon(caplog):
    child = Child("mortal", python("raise SystemExit(1)"))
    for later in (0.0, 1.0, module.STEADY + 1):
        died(child, time.monotonic() + later)
        child.poll(time.monotonic() + later + 20)
    ended(child.pid)
    assert [message.split(" in ")[1] for message in caplog.messages] == ["0.5 s", "1 s", "0.5 s"]


def test_a_refused_configuration_ends_the_whole(family):
    family.start("refuses", python("raise SystemExit(2)"))
    ended(family.children["refuses"].pid)
    with pytest.raises(ConfigRefused, match="refuses"):
        family.poll()


def test_all_end_with_the_whole(ready):
    code, wait = ready
    with Supervisor() as family:
        for name in ("first", "second", "third"):
            family.start(name, python(WORK.format(ready=code)))
            wait()
    assert [child._process.returncode for child in family.children.values()] == [0] * 3


def test_those_that_were_started_last_are_asked_first_and_all_before_any_is_waited_for(monkeypatch):
    told = []
    monkeypatch.setattr(Child, "ask_to_end", lambda child: told.append(f"ask {child.name}"))
    monkeypatch.setattr(Child, "end", lambda child, _deadline: told.append(f"end {child.name}"))
    with Supervisor() as family:
        for name in ("first", "second"):
            family.start(name, python("pass"))
    assert told == ["ask second", "ask first", "end second", "end first"]
    for child in family.children.values():
        ended(child.pid)


def test_what_others_stand_on_ends_after_them(monkeypatch):
    told = []
    monkeypatch.setattr(Child, "ask_to_end", lambda child: told.append(f"ask {child.name}"))
    monkeypatch.setattr(Child, "end", lambda child, _deadline: told.append(f"end {child.name}"))
    with Supervisor() as family:
        for name in ("router", "works", "simulation"):
            family.start(name, python("pass"), ground=name != "works")
    assert told == ["ask works", "end works", "ask simulation", "ask router", "end simulation", "end router"]
    for child in family.children.values():
        ended(child.pid)


def test_a_child_that_does_not_end_is_killed_at_the_deadline(ready, caplog, monkeypatch):
    monkeypatch.setattr(module, "GRACE", 0.05)
    code, wait = ready
    with Supervisor() as family:
        family.start("stubborn", python(STUBBORN.format(ready=code)))
        wait()
    assert caplog.messages == ["stubborn does not end; killing it"]
    assert family.children["stubborn"]._process.returncode == -signal.SIGKILL


def test_an_error_ends_all_children_too(ready):
    code, wait = ready
    family = Supervisor()
    family.start("works", python(WORK.format(ready=code)))
    wait()
    with pytest.raises(KeyboardInterrupt), family:
        raise KeyboardInterrupt
    assert family.children["works"]._process.returncode == 0


def test_a_program_that_is_not_there_does_not_leave_the_others_behind(ready):
    code, wait = ready
    family = Supervisor()
    family.start("works", python(WORK.format(ready=code)))
    wait()
    with pytest.raises(FileNotFoundError), family:
        family.start("missing", ["/nowhere/at/all"])
    assert family.children["works"]._process.returncode == 0


def test_children_that_have_ended_are_no_trouble(family):
    family.start("done", python("pass"))
    family.start("dead", python("raise SystemExit(1)"))
    for child in family.children.values():
        ended(child.pid)
