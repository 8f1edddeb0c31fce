"""What is started for a whole system, word by word."""

import argparse
import shutil
import socket
import sys
import tomllib
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import pytest

from cliffscan.cli import build_parser, plan_of
from cliffscan.common.runtime import options
from cliffscan.common.runtime.config import SERVICES, ConfigError
from cliffscan.preflight import check_free
from cliffscan.secure.folder import KeyFolder
from cliffscan.simulator.__main__ import options as simulator_options
from cliffscan.simulator.world_names import world_names
from cliffscan.system import Plan
from cliffscan.welcome import welcome


def option(command, name):
    """The values of a repeatable option."""
    return [value for word, value in pairwise(command) if word == name]


def test_the_router_listens_and_joins():
    plan = Plan("r2", ["tcp/0.0.0.0:7447", "tls/[::]:7448"], ["tcp/base:7447", "tcp/other:1"])
    words = "router --robot r2 --listen tcp/0.0.0.0:7447 --listen tls/[::]:7448"
    words += " --connect tcp/base:7447 --connect tcp/other:1"
    assert plan.router() == [sys.executable, "-m", "cliffscan", *words.split()]


def test_a_service_is_a_client_of_the_router_on_this_machine():
    words = "--robot turtlebot --mode client --connect tcp/127.0.0.1:7447"
    assert Plan().service("negative") == [sys.executable, "-m", "cliffscan.services.negative", *words.split()]


@pytest.mark.parametrize(
    ("listen", "endpoint"),
    [
        ("tcp/127.0.0.1:7447", "tcp/127.0.0.1:7447"),
        ("tcp/0.0.0.0:7447", "tcp/127.0.0.1:7447"),
        ("tcp/[::]:9", "tcp/127.0.0.1:9"),
        ("tls/0.0.0.0:7447#so_sndbuf=65536", "tls/127.0.0.1:7447#so_sndbuf=65536"),
        ("tcp/10.0.0.0:7447", "tcp/10.0.0.0:7447"),
        ("tcp/robot:7447", "tcp/robot:7447"),
    ],
)
def test_a_service_reaches_a_router_that_listens_anywhere(listen, endpoint):
    assert Plan(listen=[listen, "tcp/other:1"]).endpoint == endpoint
    assert option(Plan(listen=[listen]).service("fuse"), "--connect") == [endpoint]


def test_a_service_gets_the_configuration_and_its_own_overrides():
    overrides = ["capture.rate=5", "fuse.timeout=1", "capture.path=/a b", "scan.beams=2", "capture.source=replay"]
    Plan(overrides=overrides).check()
    plan = Plan(config=Path("/etc/robot.toml"), overrides=overrides)
    command = plan.service("capture")
    assert option(command, "--config") == ["/etc/robot.toml"]
    assert option(command, "--set") == ["capture.rate=5", "capture.path=/a b", "capture.source=replay"]
    assert option(plan.service("positive"), "--set") == option(plan.service("negative"), "--set") == ["scan.beams=2"]
    assert option(plan.service("fuse"), "--set") == ["fuse.timeout=1"]


@pytest.mark.parametrize("name", SERVICES)
def test_a_service_understands_its_command_line(name):
    parser = argparse.ArgumentParser(exit_on_error=False)
    options.add_network(parser)
    options.add_config(parser)
    plan = Plan("fleet/r", ["tcp/0.0.0.0:1"], config=Path("x.toml"), overrides=[f"{name}.a=1", f"{name}.b=-1"])
    told = parser.parse_args(plan.service(name)[3:])
    assert (told.robot, told.mode, told.config) == ("fleet/r", "client", Path("x.toml"))
    assert told.connect == ["tcp/127.0.0.1:1"]
    assert told.set == [f"{name}.a=1", f"{name}.b=-1"]


def test_the_router_understands_its_command_line():
    told = build_parser().parse_args(Plan("r", ["tcp/a:1"], ["tcp/b:2"]).router()[3:])
    assert (told.robot, told.listen, told.connect) == ("r", ["tcp/a:1"], ["tcp/b:2"])


@pytest.mark.parametrize("override", ["rate=5", "camera.rate=5", "", "=", "capture=5", " capture.rate=5"])
def test_an_override_of_no_service_is_refused(override):
    with pytest.raises(ConfigError, match=r"expected TABLE\.KEY=VALUE, TABLE one of scan, capture, negative"):
        Plan(overrides=[override]).check()


@pytest.mark.parametrize("override", [*SERVICES, "capture.rate", "fuse.", "negative.=3"])
def test_an_override_is_refused_at_once_or_by_its_service(override):
    """It must not be passed over in silence."""
    plan = Plan(overrides=[override])
    try:
        plan.check()
    except ConfigError:
        return
    assert option(plan.service(override.split(".")[0]), "--set") == [override]


@pytest.mark.parametrize(
    ("plan", "why"),
    [
        (Plan(overrides=["negative.foo=1"], world="office"), "negative.foo: is not known here$"),
        (
            Plan(overrides=["negative.flor_band=1"], world="office"),
            r"negative.flor_band: is not known here; did you mean floor_band\?$",
        ),
        (Plan(overrides=["capture.rate=fast"], world="office"), "capture.rate: Input should be a valid number"),
        (Plan(overrides=["negativ.beams=2"]), r"--set negativ.beams=2: .*; did you mean negative\?$"),
        (Plan(world="ofice"), r"no world is named 'ofice'; .*; did you mean office\?$"),
        (Plan(config=Path("/nowhere/robot.toml")), "/nowhere/robot.toml: No such file or directory"),
        (Plan(world="atlantis"), "no world is named 'atlantis'"),
        (Plan(world="random:x"), "no world is named 'random:x'"),
    ],
)
def test_what_a_process_would_refuse_is_refused_before_any_is_started(plan, why):
    with pytest.raises(ConfigError, match=f"^{why}"):
        plan.check()


def test_an_endpoint_that_is_taken_is_refused():
    with socket.create_server(("127.0.0.1", 0)) as other:
        taken = f"tcp/127.0.0.1:{other.getsockname()[1]}"
        with pytest.raises(ConfigError, match=f"^{taken}: Address already in use; does cliffscan run already"):
            check_free(taken)
    check_free(taken)
    check_free("tcp/robot..local:7447")  # no host can have that name: the router says so
    check_free("udp/127.0.0.1:1")
    check_free("tcp/robot..local:7447")  # no host can have that name: the router says so


@pytest.mark.parametrize("listen", [["tcp/0.0.0.0:7447"], ["tcp/127.0.0.1:1", "tcp/[::]:7447"]])
def test_a_robot_is_open_to_others_only_where_that_is_said(listen):
    plan = Plan(listen=listen, overrides=["capture.source=replay"])
    with pytest.raises(ConfigError, match=r"add --secure DIR .* or --insecure$"):
        plan.check()
    replace(plan, insecure=True).check()
    assert replace(plan, insecure=True).router()[-1] == "--insecure"


def test_keys_are_looked_at_before_anything_is_started(tmp_path):
    keys = tmp_path / "keys"
    plan = plan_of(build_parser().parse_args(["up", "--secure", str(keys)]))
    with pytest.raises(ConfigError, match=f"{keys}: is not there: is the name right"):
        plan.check()
    KeyFolder(keys).init("turtlebot", [])
    plan.check()
    assert plan.endpoint == "tls/127.0.0.1:7447"
    assert option(plan.service("fuse"), "--secure") == option(plan.router(), "--secure") == [str(keys)]
    assert f"cliffscan status --secure {keys}" in welcome(plan)
    shutil.rmtree(keys / "fuse")
    with pytest.raises(ConfigError, match=f"{keys}/fuse: is not there"):
        plan.check()


def part(*words):
    return plan_of(build_parser().parse_args(["up", *words]))


ROBOT, WORKSTATION = ("--part", "robot", "--insecure"), ("--part", "workstation", "--connect", "tcp/robot:7447")
CAMERA = ("--base", "real", "--set", "capture.source=kinect")


@pytest.mark.parametrize(
    ("words", "services"),
    [
        ([*ROBOT], ["capture", "kobuki"]),
        ([*ROBOT, *CAMERA], ["capture", "kobuki"]),
        ([*ROBOT, *CAMERA, "--perception"], ["capture", "perception", "kobuki"]),
        ([*ROBOT, "--base", "none", "--set", "capture.source=kinect"], ["capture"]),
        ([*WORKSTATION], ["negative", "positive", "fuse"]),
        ([*WORKSTATION, "--perception"], ["perception"]),
        (["--perception"], ["capture", "perception", "kobuki"]),
    ],
)
def test_each_part_starts_its_own_services(words, services):
    plan = part(*words)
    plan.check()
    assert plan.services == services
    assert "cliffscan status" in welcome(plan)
    assert "0.0.0.0" not in welcome(plan)  # noqa: S104 - to which nobody connects


def test_the_two_parts_meet_at_the_robots_port():
    robot, workstation = part(*ROBOT), part(*WORKSTATION)
    assert option(robot.router(), "--listen") == ["tcp/0.0.0.0:7447"]
    assert option(workstation.router(), "--listen") == ["tcp/127.0.0.1:7447"]
    assert option(workstation.router(), "--connect") == ["tcp/robot:7447"]
    assert [option(each.router(), "--name") for each in (robot, workstation)] == [["robot"], ["workstation"]]
    assert robot.endpoint == workstation.endpoint == "tcp/127.0.0.1:7447"


def test_with_keys_the_parts_have_the_keys_of_their_roles(tmp_path):
    keys = tmp_path / "keys"
    KeyFolder(keys).init("turtlebot", ["robot.local"])
    robot, workstation = (part("--part", name, "--secure", str(keys)) for name in ("robot", "workstation"))
    for plan, role in ((robot, "router"), (workstation, "router-workstation")):
        plan.check()
        assert option(plan.router(), "--role") == [role]
        assert plan.endpoint == "tls/127.0.0.1:7447"
    assert option(robot.router(), "--listen") == ["tls/0.0.0.0:7447"]


def test_perception_takes_the_settings_of_the_three():
    overrides = ["scan.beams=90", "negative.methods=['near_edge']", "fuse.timeout=1", "kobuki.max_linear=0.1"]
    assert option(Plan(overrides=overrides, perception=True).service("perception"), "--set") == overrides[:3]


@pytest.mark.parametrize(
    ("words", "why"),
    [
        (["--part", "robot"], "--listen tcp/0.0.0.0:7447: any machine .* add --secure DIR .* or --insecure$"),
        (["--part", "workstation"], r"where is the robot\? add --connect tcp/ROBOT:7447$"),
        ([*WORKSTATION, "--base", "real"], "^--base real: camera and base are of --part robot: leave it out$"),
        ([*WORKSTATION, "--world", "office"], "^--world office: camera and base are of --part robot"),
        (
            [*WORKSTATION, "--set", "capture.rate=5"],
            r"capture is not of --part workstation \(negative, positive, fuse\)",
        ),
        ([*WORKSTATION, "--set", "colour=5"], "expected TABLE.KEY=VALUE"),
        ([*ROBOT, "--set", "fuse.timeout=1"], r"fuse is not of --part robot \(capture, kobuki\)"),
        ([*ROBOT, "--base", "real"], "no camera is named: add --set capture.source=kinect$"),
        ([*ROBOT, *CAMERA, "--set", "kobuki.max_linear=5"], "kobuki.max_linear: "),
        (["--part", "workstation", "--connect", "tcp/:7447"], "--connect tcp/:7447: names no host"),
        (["--part", "workstation", "--connect", "tcp/robot:74470"], "tcp/robot:74470: there is no such port"),
    ],
)
def test_a_part_that_cannot_be_is_refused_before_anything_is_started(words, why):
    with pytest.raises(ConfigError, match=why):
        part(*words).check()


def test_keys_that_name_no_host_of_the_robot_are_told(tmp_path):
    keys = tmp_path / "keys"
    KeyFolder(keys).init("turtlebot", [])
    with pytest.raises(ConfigError, match=r"make keys with --host ROBOT .* names none.*, or add --connect tls/"):
        part("--part", "workstation", "--secure", str(keys)).check()


def test_a_world_takes_the_place_of_base_and_camera():
    plan = Plan(overrides=["capture.pitch=10", "capture.rate=15"], world="random:3", folder="/run/x")
    plan.check()
    processes = plan.base_processes()
    assert list(processes) == ["simulation", "kobuki"]
    assert option(processes["kobuki"], "--set") == ["kobuki.port=/run/x/kobuki"]
    overrides = ["capture.pitch=10", "capture.rate=15", "capture.source=simulator", "capture.simulation=/run/x/frames"]
    assert option(plan.capture(), "--set") == overrides
    told = simulator_options().parse_args(processes["simulation"][3:])
    assert (told.world, told.pitch, told.rate, told.height) == ("random:3", 10.0, 15.0, 0.30)
    assert (str(told.link), told.frames) == ("/run/x/kobuki", "/run/x/frames")


def test_without_a_world_the_base_is_the_one_named():
    assert Plan().base_processes() == {}
    assert option(Plan(base="real").base_processes()["kobuki"], "--set") == []
    assert option(Plan().capture(), "--set") == []


KINECT, REPLAY, SIMULATOR = (f"capture.source={name}" for name in ("kinect", "replay", "simulator"))


@pytest.mark.parametrize(
    ("plan", "why"),
    [
        (Plan(base="real", world="office"), "real base"),
        (Plan(base="real"), "no camera is named: add --set capture.source=kinect$"),
        (Plan(), "no camera is named: add --set capture.source=kinect, or replay"),
        (Plan(base="real", overrides=[SIMULATOR]), "capture.source=simulator does not show where .*=kinect"),
        (Plan(base="real", overrides=[REPLAY]), "capture.source=replay does not show where .*=kinect"),
        (Plan(world="office", overrides=[KINECT]), "add --base real, or --base none$"),
        (Plan(world="office", overrides=[REPLAY]), "add --base real, or --base none$"),
        (Plan(world="office", overrides=["capture.world=landing"]), "--world NAME chooses it$"),
        (Plan(world="office", overrides=["capture.simulation=/x"]), "add --base none$"),
        (Plan(world="office", overrides=["kobuki.port=/dev/kobuki"]), "add --base real for this one$"),
    ],
)
def test_a_base_and_a_camera_that_are_not_in_the_same_place_are_refused(plan, why):
    with pytest.raises(ConfigError, match=why):
        plan.check()


@pytest.mark.parametrize(
    "plan",
    [
        Plan(base="real", overrides=[KINECT]),
        Plan(overrides=[REPLAY]),
        Plan(overrides=[SIMULATOR]),
        Plan(world="office", overrides=[SIMULATOR, "capture.world=office"]),
    ],
)
def test_a_base_and_a_camera_that_belong_together_are_taken(plan):
    plan.check()


def test_a_camera_may_be_named_in_the_file(tmp_path):
    file = tmp_path / "robot.toml"
    file.write_text("[capture]\nsource = 'kinect'\n")
    Plan(base="real", config=file).check()
    with pytest.raises(ConfigError, match="add --base real"):
        Plan(world="office", config=file).check()


def test_without_options_the_robot_is_simulated():
    plan = plan_of(build_parser().parse_args(["up"]))
    assert (plan.world, plan.base) == ("paper_room", "none")
    assert plan.services == list(SERVICES)


def test_a_world_is_for_a_simulated_robot():
    with pytest.raises(ConfigError, match="leave out --base real"):
        plan_of(build_parser().parse_args(["up", "--base", "real", "--world", "office"]))


@pytest.mark.parametrize("words", [[], ["--base", "real"], ["--base", "none"], ["--robot", "r2"]])
def test_the_first_lines_fit_a_terminal_and_say_what_to_type_next(words):
    shown = welcome(plan_of(build_parser().parse_args(["up", "--set", "capture.source=simulator", *words])))
    assert "cliffscan status" in shown
    assert max(map(len, shown.splitlines())) <= 80
    assert ("cliffscan drive" in shown) == ("none" not in words)
    assert ("world paper_room" in shown) == ("--base" not in words)
    assert ("--base real --set capture.source=kinect" in shown) == ("--base" not in words)
    assert ("status --robot r2" in shown) == ("r2" in words)


COMMANDS = [
    "",
    "keys",
    "keys init",
    "keys issue",
    "keys renew",
    "keys check",
    "up",
    "router",
    "status",
    "list",
    "alive",
    "calibrate",
    "drive",
    "echo",
    "doctor",
    "systemd",
]


@pytest.mark.parametrize("command", COMMANDS)
def test_help_fits_80_columns(command, capsys, monkeypatch):
    monkeypatch.setenv("COLUMNS", "80")
    with pytest.raises(SystemExit):
        build_parser().parse_args([*command.split(), "--help"])
    told = capsys.readouterr().out
    assert max(map(len, told.splitlines())) <= 80
    if command == "up":
        assert all(world in told for world in world_names())


@pytest.mark.parametrize("words", [["--world", "office"], ["--base", "none", "--set", "capture.source=kinect"]])
def test_a_dump_of_all_services_is_taken_again(words, tmp_path):
    def plan(*more):
        return plan_of(build_parser().parse_args(["up", *words, *more]))

    file = tmp_path / "robot.toml"
    file.write_text(plan("--set", "scan.beams=90", "--set", "fuse.inputs.lidar.key=scan/lidar").dump())
    tables = tomllib.loads(file.read_text())
    assert set(tables) == {"scan", *SERVICES}
    assert tables["scan"]["beams"] == 90
    again = plan("--config", str(file))
    again.check()
    assert again.dump() == file.read_text()
