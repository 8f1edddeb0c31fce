"""How a service is configured, starts, and ends."""

import signal
import sys
import tomllib

import pytest

from cliffscan.common.runtime.config import CONFIGURED, SENSING, SHARED
from cliffscan.services.capture.sources.kinds import KINDS
from tests import forked
from tests.service.conftest import DEADLINE, free_endpoint

CAPTURE = "services.capture"
SIMULATOR = ("--set", "capture.source=simulator")


def needed(service):
    """The options without which a service does not start."""
    return SIMULATOR if service == "capture" else ()


@pytest.mark.parametrize("service", CONFIGURED)
def test_dump_config_reads_back_to_itself(service, tmp_path, ask_here):
    module = f"services.{service}"
    first = ask_here(module, "--dump-config")
    assert first.returncode == 0
    shared = [table for table, readers in SHARED.items() if service in readers]
    assert list(tomllib.loads(first.stdout)) == [*shared, service]
    file = tmp_path / "config.toml"
    file.write_text(first.stdout)
    assert ask_here(module, "--config", str(file), "--dump-config").stdout == first.stdout


@pytest.mark.parametrize(
    ("options", "reason"),
    [
        (["--set", "scan.floor_band=-1"], "scan.floor_band"),
        (["--set", "negative.floor_band=0.04"], "negative.floor_band: write scan.floor_band"),
        (["--set", "negative.colour=red"], "negative.colour"),
        (["--set", "negative.methods=[]"], "negative.methods"),
        (["--set", "floor_band"], "expected negative.KEY=VALUE"),
        (["--set", "capture.rate=5"], "this service reads negative.KEY and scan.KEY only"),
        (["--config", "nowhere.toml"], "nowhere.toml"),
        (["--connect", "nonsense"], "names no protocol"),
        (["--robot", "a*b"], "no robot name"),
    ],
)
def test_a_bad_setting_is_refused_with_one_line(options, reason, ask_here):
    refused = ask_here("services.negative", *options)
    assert refused.returncode == 2
    last = refused.stderr.strip().splitlines()[-1]
    assert reason in last
    assert "Traceback" not in refused.stderr
    if "--robot" not in options:
        assert refused.stderr.count("\n") == 1


def test_capture_without_a_source_is_refused_before_it_looks_for_a_router():
    refused = forked.ask("services.capture", "--mode", "client", "--connect", free_endpoint(), timeout=DEADLINE)
    assert refused.returncode == 2
    assert refused.stderr == (
        f"capture: capture.source is not set: choose one of {', '.join(KINDS)}, as --set capture.source=kinect\n"
    )
    assert refused.stdout == ""


def test_a_dump_tells_what_is_missing_and_can_be_filled_in(tmp_path, ask_here):
    file = tmp_path / "config.toml"
    file.write_text(ask_here(CAPTURE, "--dump-config").stdout)
    assert file.read_text().startswith("# capture.source is not set: choose one of ")
    chosen = ask_here(CAPTURE, "--config", str(file), *SIMULATOR, "--dump-config").stdout
    assert tomllib.loads(chosen)["capture"]["source"] == "simulator"
    assert "is not set" not in chosen


@pytest.mark.parametrize(
    ("settings", "reason"),
    [
        (["source=replay"], "camera.json"),
        (["source=replay", "path=/nowhere"], "/nowhere/camera.json"),
        (["source=simulator", "world=the moon"], "paper_room"),
    ],
)
def test_a_source_that_can_never_be_opened_is_refused_with_one_line(client, start, settings, reason):
    options = [word for setting in settings for word in ("--set", f"capture.{setting}")]
    process = start("capture", *options, wait=False)
    process.expected = 2
    assert process.end() == 2
    assert reason in process.said
    assert process.said.count("\n") == 1


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT])
def test_a_signal_before_a_service_has_loaded_its_libraries_ends_it_with_0(start, number):
    process = start("negative", wait=False, PYTHONVERBOSE="1")  # says which modules are loaded
    process.wait_said("import 'services'")
    process.signal(number)
    assert process.end() == 0


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT])
@pytest.mark.parametrize("service", [*SENSING, "perception", "gate", "ros2"])
def test_a_signal_ends_a_service_with_0(client, start, service, number):
    process = start(service, *needed(service), fresh=number == signal.SIGTERM)
    process.signal(number)
    assert process.end() == 0
    client.wait_alive(service, alive=False)


def test_a_service_waits_for_its_router_and_still_ends_with_0(start):
    process = start("fuse", wait=False, where=["--mode", "client", "--connect", free_endpoint()])
    process.wait_said("waiting for a router")
    process.signal(signal.SIGTERM)
    assert process.end() == 0


def test_a_signal_during_compilation_ends_a_service_with_0(client, start, tmp_path):
    status = client.listen("status/negative")
    process = start("negative", wait=False, NUMBA_CACHE_DIR=str(tmp_path))
    assert status.get()["state"] == "starting"
    process.signal(signal.SIGTERM)
    assert process.end() == 0


def test_with_no_endpoint_services_find_each_other(client, start, run):
    """All by themselves: what `echo` hears came from fuse, which heard positive and negative, which heard capture."""
    started = [start(service, *needed(service), wait=False, where=[]) for service in SENSING]
    for process in started:
        process.wait_said("ready")
    command = [sys.executable, "-m", "cliffscan", "echo", "scan/fused", "--robot", client.robot, "--count", "1"]
    assert run(command).end() == 0


def test_cliffscan_run_is_the_service(client, run):
    endpoint = ["--robot", client.robot, "--connect", client.endpoint]
    process = run([sys.executable, "-m", "cliffscan", "run", "fuse", *endpoint, "--set", "fuse.timeout=1"])
    client.wait_alive("fuse")
    assert client.listen("status/fuse").get()["pid"] == process.process.pid
    process.signal(signal.SIGTERM)
    assert process.end() == 0


@pytest.mark.parametrize(
    ("words", "reason"),
    [(["nothing"], "choose from 'capture', "), (["fuse", "--set", "fuse.timeout=-1"], "fuse: fuse.timeout: ")],
)
def test_cliffscan_run_refuses_what_it_cannot_run(words, reason):
    refused = forked.ask("cliffscan", "run", *words, timeout=DEADLINE)
    assert refused.returncode == 2
    assert reason in refused.stderr.splitlines()[-1]
