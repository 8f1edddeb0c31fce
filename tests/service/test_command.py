"""The command `cliffscan`: up, status, echo, alive."""

import os
import re
import signal
import subprocess
import sys

import pytest

from tests.service.conftest import DEADLINE, free_endpoint


def cliffscan(*words):
    return [sys.executable, "-m", "cliffscan", *words]


def ask(*words):
    return subprocess.run(cliffscan(*words), capture_output=True, text=True, timeout=DEADLINE, check=False)


@pytest.fixture
def place(client):
    return ["--robot", client.robot, "--connect", client.endpoint]


@pytest.fixture
def up(client, run):
    """The whole system on a router of its own, which joins the client's."""
    endpoint = free_endpoint()
    place = ["--robot", client.robot, "--listen", endpoint, "--connect", client.endpoint]
    process = run(cliffscan("up", *place, "--set", "capture.source=simulator", "--set", "capture.rate=5"))
    for service in ("router", "negative", "positive", "fuse", "capture"):
        client.wait_alive(service)
    return process


def pid_of(client, service):
    return client.listen(f"status/{service}").get()["pid"]


def test_up_starts_all_and_restarts_what_dies_and_ends_all(client, up):
    ear = client.listen("scan/fused")
    assert len(ear.get()["ranges"]) == 4 * 640
    pids = {service: pid_of(client, service) for service in ("capture", "negative", "positive", "fuse")}
    os.kill(pids["negative"], signal.SIGKILL)
    up.wait_said("negative died (signal 9); starting it again in 0.5 s")
    client.wait_alive("negative", alive=False)
    client.wait_alive("negative")
    pids["negative"] = pid_of(client, "negative")
    ear.all()
    assert ear.get()
    up.signal(signal.SIGTERM)
    assert up.end() == 0
    for pid in pids.values():
        with pytest.raises(ProcessLookupError):
            os.kill(pid, 0)


def test_status_shows_who_lives(client, start, place):
    empty = ask("status", *place)
    assert empty.returncode == 1
    start("fuse")
    shown = ask("status", *place)
    assert shown.returncode == 0
    assert re.search(r"fuse\s.*working", shown.stdout)


def test_alive_tells_by_its_exit_code(start, place):
    assert ask("alive", "fuse", *place).returncode == 1
    start("fuse")
    assert ask("alive", "fuse", *place).returncode == 0


def test_echo_prints_what_is_said_and_what_is_wrong_with_it(client, start, place):
    start("fuse")
    status = ask("echo", "status/fuse", "--count", "1", *place)
    assert '"service": "fuse"' in status.stdout
    assert ask("echo", "scan/nothing", "--count", "1", "--timeout", "0.2", *place).returncode == 1


def test_up_refuses_what_a_service_refuses(client, run):
    process = run(cliffscan("up", "--robot", client.robot, "--listen", free_endpoint(), "--set", "negative.beams=none"))
    process.expected = 2
    assert process.end() == 2
    assert "cliffscan: negative.beams: " in process.said


def test_up_refuses_a_setting_of_no_service():
    refused = ask("up", "--set", "colour=red")
    assert refused.returncode == 2
    assert refused.stderr.strip().count("\n") == 0


def test_up_starts_nothing_where_another_router_listens(client):
    refused = ask("up", "--robot", client.robot, "--listen", client.endpoint)
    assert refused.returncode == 2
    assert refused.stderr == f"cliffscan: {client.endpoint}: Address already in use; does cliffscan run already?\n"


def test_a_router_is_found_without_being_named(client, run):
    """By those who say nothing of the network, as the README's commands and its little programs."""
    run(cliffscan("router", "--robot", client.robot, "--listen", free_endpoint()))
    for _ in range(20):  # each waits for a second
        if ask("alive", "router", "--robot", client.robot).returncode == 0:
            return
    pytest.fail("not found")


def test_echo_refuses_what_is_no_key(place):
    refused = ask("echo", "scan//fused", *place)
    assert refused.returncode == 2
    assert refused.stderr.startswith("cliffscan: 'scan//fused' is no key: ")
    assert refused.stderr.count("\n") == 1
