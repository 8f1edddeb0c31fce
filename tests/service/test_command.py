"""The command `cliffscan`: up, status, list, echo, alive."""

import contextlib
import os
import re
import signal
import subprocess
import sys
import time

import pytest

from cliffscan.cli import HOST
from cliffscan.common.runtime.config import SERVICES
from tests import forked
from tests.service.conftest import DEADLINE, free_endpoint, wait_until


def cliffscan(*words):
    return [sys.executable, "-m", "cliffscan", *words]


def ask(*words):
    return forked.ask("cliffscan", *words, timeout=DEADLINE)


def ask_until(holds, *words):
    """What a command prints, as soon as `holds` is true of it: it looks for a second, in which a fact may not come."""
    deadline = time.monotonic() + DEADLINE
    while not holds(done := ask(*words)):
        assert time.monotonic() < deadline, done
    return done


@pytest.fixture
def place(client):
    return ["--robot", client.robot, "--connect", client.endpoint]


@pytest.fixture
def up(client, run):
    """A simulated robot on a router of its own, which joins the client's."""
    endpoint = free_endpoint()
    place = ["--robot", client.robot, "--listen", endpoint, "--connect", client.endpoint]
    process = run(cliffscan("up", *place, "--set", "capture.rate=5"))
    for service in (f"router-{HOST}", *SERVICES):
        client.wait_alive(service)
    return process


def pid_of(client, service):
    return client.listen(f"status/{service}").get()["pid"]


def test_up_starts_all_and_restarts_what_dies_and_ends_all(client, up):
    ear = client.listen("scan/fused")
    assert len(ear.get()["ranges"]) == 4 * 640
    pids = {service: pid_of(client, service) for service in ("capture", "negative", "positive", "fuse")}
    os.kill(pids["negative"], signal.SIGTERM)
    up.wait_said("negative ended (exit 0); starting it again in 0.5 s")
    client.wait_alive("negative", alive=False)
    client.wait_alive("negative")
    pids["negative"] = pid_of(client, "negative")
    ear.all()
    assert ear.get()
    before = len(up.said)
    up.signal(signal.SIGTERM)
    assert up.end() == 0
    for pid in pids.values():
        with pytest.raises(ProcessLookupError):
            os.kill(pid, 0)
    assert "a simulated TurtleBot 2 in the world paper_room" in up.said
    alarms = re.findall(r".* (?:WARNING|ERROR) (?:kobuki|capture|cliffscan): .*", up.said[before:])
    assert [each for each in alarms if "does not end; killing it" not in each] == []  # a busy machine takes its time


def test_status_says_that_nothing_answers():
    endpoint = free_endpoint()
    empty = ask("status", "--connect", endpoint)
    assert f"nothing of robot turtlebot found at {endpoint}, where nothing answers; is" in empty.stderr


def test_status_shows_who_lives(client, start, place):
    empty = ask("status", *place)
    assert empty.returncode == 1
    place_of_it = f"at {client.endpoint}"
    assert (
        empty.stderr == f"cliffscan: nothing of robot {client.robot} found {place_of_it}; is `cliffscan up` running?\n"
    )
    start("fuse")
    shown = ask_until(lambda done: re.search(r"fuse\s.*working", done.stdout), "status", *place)
    assert shown.returncode == 0
    assert "not found: capture, kobuki, negative, positive" in shown.stdout


def test_status_shows_what_is_malicious_and_goes_on(client, start, place):
    fields = {"stamp": 1, "service": "evil", "version": "", "state": "working", "pid": 1, "uptime": 1.0, "rate": 1.0}
    fields |= {"latency": [0.0, 0.0], "counts": {}, "note": "[/x]\x1b[2J"}
    shown = subprocess.Popen(cliffscan("status", *place), stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    while shown.poll() is None:
        client.put("status/evil", fields)
        with contextlib.suppress(subprocess.TimeoutExpired):
            shown.wait(0.05)
    out, err = shown.communicate()
    assert err == ""
    assert "evil: [/x]\\u001b[2J" in out


def test_status_of_another_robot_names_those_that_are_found(client, start, place):
    start("fuse")
    others = f"other robots found: {client.robot} "
    asked = ask_until(lambda done: others in done.stderr, "status", "--robot", "nobody", "--connect", client.endpoint)
    assert asked.returncode == 1


def test_list_names_live_keys_and_robots(client, start, place):
    nothing = ask("list", *place)
    assert nothing.returncode == 1
    assert "nothing of robot" in nothing.stderr
    start("fuse")
    status = rf"{client.robot}/status/fuse +\d\.\d Hz  ServiceStatus\n"
    keys = ask_until(lambda done: re.search(status, done.stdout), "list", *place).stdout
    assert f"{client.robot}/alive/fuse " in keys
    ask_until(lambda done: f"{client.robot}: fuse\n" in done.stdout, "list", "--all", *place)


def test_alive_tells_by_its_exit_code(start, place):
    asked = ask("alive", "fuse", *place)
    assert asked.returncode == 1
    assert "is `cliffscan up` running?" in asked.stderr
    start("fuse")
    wait_until(lambda: ask("alive", "fuse", *place).returncode == 0)
    wait_until(lambda: ask("alive", "fuze", *place).stderr.endswith("there are fuse; did you mean fuse?\n"))
    assert ask("alive", "fuze", *place).returncode == 1


def test_echo_prints_what_is_said_and_what_is_wrong_with_it(client, start, place):
    start("fuse")
    status = ask("echo", "status/fuse", "--count", "1", *place)
    assert '"service": "fuse"' in status.stdout
    words = ("echo", "status/fuze", "--count", "1", "--timeout", "0.2", *place)
    nothing = ask_until(lambda done: "live keys are" in done.stderr, *words)
    assert nothing.returncode == 1
    key = f"{client.robot}/status/fuze"
    told = f"cliffscan: nothing on {key} within 0.2 s; live keys are status/fuse; did you mean status/fuse?\n"
    assert nothing.stderr == told


def test_echo_waits_for_a_router_no_longer_than_it_is_told():
    nobody = ask("echo", "scan/fused", "--timeout", "0.2", "--mode", "client", "--connect", free_endpoint())
    assert nobody.returncode == 1
    assert nobody.stderr.splitlines()[-1] == "cliffscan: no router within 0.2 s"
    assert "Connection refused" in nobody.stderr


def test_up_refuses_what_a_service_refuses(client, run):
    process = run(cliffscan("up", "--robot", client.robot, "--listen", free_endpoint(), "--set", "scan.beams=none"))
    process.expected = 2
    assert process.end() == 2
    assert "cliffscan: scan.beams: " in process.said


def test_up_refuses_a_setting_of_no_service():
    refused = ask("up", "--set", "colour=red")
    assert refused.returncode == 2
    assert refused.stderr.strip().count("\n") == 0


@pytest.mark.parametrize("source", ["simulator", "replay"])
def test_up_starts_no_real_base_beside_pictures_of_elsewhere(source):
    refused = ask("up", "--base", "real", "--set", f"capture.source={source}")
    assert refused.returncode == 2
    assert refused.stderr.count("\n") == 1
    assert "add --set capture.source=kinect" in refused.stderr


def test_up_starts_nothing_where_another_router_listens(client):
    refused = ask("up", "--robot", client.robot, "--listen", client.endpoint)
    assert refused.returncode == 2
    assert refused.stderr == f"cliffscan: {client.endpoint}: Address already in use; does cliffscan run already?\n"


def test_a_router_is_found_without_being_named(client, run, meeting_point):
    """By those who say nothing of where it is, as the README's commands and its little programs."""
    place = ["--robot", client.robot, "--zenoh-config", meeting_point]
    run(cliffscan("router", *place, "--listen", free_endpoint(), "--name", "here"))

    def is_alive(service: str) -> bool:  # each waits for a second
        return ask("alive", service, *place).returncode == 0

    wait_until(lambda: is_alive("router"))
    wait_until(lambda: is_alive("router-here"))
    assert not is_alive("router-there")


def test_echo_refuses_what_is_no_key(place):
    refused = ask("echo", "scan//fused", *place)
    assert refused.returncode == 2
    assert refused.stderr.startswith("cliffscan: 'scan//fused' is no key: ")
    assert refused.stderr.count("\n") == 1


def test_the_doctor_finds_what_is_there_and_what_is_not(client, start, place):
    start("fuse")
    working = re.compile(r"^\w+ +fuse +working", re.MULTILINE)
    words = ("doctor", *place, "--seconds", "1.5", "--part", "workstation")
    looked = ask_until(lambda done: working.search(done.stdout), *words)
    assert looked.returncode == 1
    assert re.search(r"^fault +capture +is not found: `cliffscan run capture`", looked.stdout, re.MULTILINE)
    assert re.search(r"^warning +kobuki +is not found", looked.stdout, re.MULTILINE)
    assert "base port" not in looked.stdout


def test_the_doctor_looks_at_the_devices_whatever_the_keys_are(tmp_path):
    (tmp_path / "recorder").mkdir()
    (tmp_path / "recorder/cert.pem").write_text("")
    looked = ask("doctor", "--secure", str(tmp_path), "--part", "robot")
    assert looked.returncode == 1
    assert re.search(r"fault +keys of recorder", looked.stdout)
    assert re.search(r"fault +network .*copy the folder recorder from where", looked.stdout)
    assert re.search(r"\w+ +base ", looked.stdout)


def test_who_asks_whether_a_service_is_alive_waits_for_no_router_for_ever():
    asked = ask("alive", "fuse", "--mode", "client", "--connect", free_endpoint())
    assert asked.returncode == 1
    assert "no router within 5 s" in asked.stderr


def test_the_doctor_names_a_router_that_is_not_there():
    looked = ask("doctor", "--connect", free_endpoint(), "--mode", "client")
    assert looked.returncode == 1
    assert "Connection refused: is a router running there?" in looked.stdout
