"""The units of each part: what they start, what they may reach, and that systemd takes them."""

import shutil
import subprocess

import pytest

from cliffscan.cli import build_parser
from cliffscan.common.runtime.config import ConfigError

KINECT = ("--set", "capture.source=kinect")
PARTS = {
    "both": [*KINECT],
    "robot": ["--part", "robot", "--insecure", "--perception", *KINECT],
    "workstation": ["--part", "workstation", "--connect", "tcp/robot.local:7447"],
}
SERVICES = {
    "both": {"capture", "negative", "positive", "fuse", "kobuki"},
    "robot": {"capture", "perception", "kobuki"},
    "workstation": {"negative", "positive", "fuse"},
}


def written(folder, *words):
    """The units that the command writes, by name."""
    arguments = build_parser().parse_args(["systemd", "--user", "root", "--out", str(folder), *words])
    assert arguments.command(arguments, None) == 0
    return {file.name: file.read_text() for file in folder.iterdir()}


def values(unit, key):
    """All values of a key of a unit."""
    return [line.partition("=")[2] for line in unit.splitlines() if line.startswith(f"{key}=")]


@pytest.fixture(params=PARTS)
def part(request):
    return request.param


def test_each_part_has_a_unit_for_each_process(part, tmp_path):
    made = written(tmp_path, *PARTS[part])
    names = {f"cliffscan-{name}.service" for name in {"router", *SERVICES[part]}}
    assert set(made) == {"cliffscan.target", *names}
    assert set(values(made["cliffscan.target"], "Wants")[0].split()) == names


def test_each_process_is_restarted_but_for_a_configuration_that_is_refused(part, tmp_path):
    for name, unit in written(tmp_path, *PARTS[part]).items():
        if name.endswith(".service"):
            assert values(unit, "Restart") == ["always"]
            assert values(unit, "RestartPreventExitStatus") == ["2"]
            assert "network-online.target" in values(unit, "After")[0]


def test_only_camera_and_base_reach_a_device(tmp_path):
    for name, unit in written(tmp_path, *PARTS["robot"]).items():
        if name in ("cliffscan-capture.service", "cliffscan-kobuki.service"):
            allowed = " ".join(values(unit, "DeviceAllow"))
            assert ("usb_device" in allowed) == ("capture" in name) == ("ttyUSB" not in allowed)
            assert values(unit, "DevicePolicy") == ["closed"]
            modules = {"modprobe@videodev"} if "capture" in name else {"modprobe@usbserial", "modprobe@cdc_acm"}
            for key in ("After", "Wants"):  # else systemd knows no device of that name when the unit starts
                assert {f"{module}.service" for module in modules} <= set(values(unit, key)[0].split())
        elif name.endswith(".service"):
            assert values(unit, "PrivateDevices") == ["yes"]


def test_a_word_reaches_the_process_as_it_was_typed(tmp_path):
    unit = written(tmp_path, *KINECT, "--set", 'kobuki.port=/dev/a b%i$HOME"\\')["cliffscan-kobuki.service"]
    assert r'--set "kobuki.port=/dev/a b%%i$$HOME\"\\"' in values(unit, "ExecStart")[0]


def test_what_is_printed_is_what_is_written(tmp_path, capsys):
    made = written(tmp_path, *PARTS["both"])
    arguments = build_parser().parse_args(["systemd", "--user", "nobody-here", *PARTS["both"]])
    arguments.command(arguments, None)
    shown = capsys.readouterr()
    for name in made:
        assert f"# /etc/systemd/system/{name}\n" in shown.out
    assert "There is no user nobody-here here: sudo useradd --system" in shown.err


@pytest.mark.parametrize(
    ("words", "why"),
    [
        ([], "no camera is named"),
        (["--base", "simulated"], "units are for a robot"),
        (["--part", "robot", *KINECT], "add --secure DIR"),
        (["--part", "workstation"], "where is the robot"),
    ],
)
def test_what_up_would_refuse_gets_no_units(words, why, tmp_path):
    with pytest.raises(ConfigError, match=why):
        written(tmp_path, *words)


def test_a_folder_that_cannot_be_written_is_told(tmp_path):
    (tmp_path / "file").touch()
    with pytest.raises(ConfigError, match=r"--out .*file.*; name a folder that you may write$"):
        written(tmp_path / "file/units", *KINECT)


@pytest.mark.skipif(not shutil.which("systemd-analyze"), reason="needs Debian's package systemd (systemd-analyze)")
def test_systemd_takes_the_units(part, tmp_path):
    written(tmp_path, *PARTS[part])
    files = sorted(map(str, tmp_path.iterdir()))
    verified = subprocess.run(["systemd-analyze", "verify", *files], capture_output=True, text=True, check=False)
    assert (verified.returncode, verified.stderr) == (0, "")
