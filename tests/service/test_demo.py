"""The demo's experiments through real services: pictures, tables and figures within bounds; a clean end."""

import json
import os
import re
import signal
import subprocess
import sys
from pathlib import Path

import psutil
import pytest
from PIL import Image

from tests import forked, scenes
from tests.service.conftest import DEADLINE, free_port

SCANS = ["farthest_point", "virtual_floor", "paper", "near_edge"]
TOP = Path(__file__).parents[2]
PATIENCE = 150  # [s] for kernels that have never been compiled


def command(*words):
    return [sys.executable, "-m", "experiments", *map(str, words)]


def experiments(*words):
    return subprocess.run(command(*words), capture_output=True, text=True, timeout=PATIENCE, check=False)


def rows(file):
    """The table's cells below its headings."""
    lines = [line for line in file.read_text().splitlines() if line.startswith("|")]
    return [[cell.strip() for cell in line.strip("|").split("|")] for line in lines[2:]]


def number(cell):
    return float(re.sub("[ %]", "", cell))


def test_the_script_finds_the_experiments_from_any_folder(tmp_path):
    done = subprocess.run([TOP / "demo", "--help"], cwd=tmp_path, capture_output=True, text=True, timeout=PATIENCE)
    assert done.returncode == 0, done.stderr
    assert "usage" in done.stdout


@pytest.fixture
def folder(tmp_path):
    """A depth folder of a hole before a wall, from two heights, and a PNG that is none."""
    made = tmp_path / "recording"
    made.mkdir()
    frames = {}
    for name, height in (("low", 0.3), ("high", 0.6)):
        camera = scenes.camera(160, 120, scenes.FloorPlane.from_mount(height))
        Image.fromarray(scenes.depth(camera, [scenes.HOLE])).save(made / f"{name}.png")
        frames[name] = {"floor": camera.floor}
    (made / "broken.png").write_bytes(b"no picture")
    told = {"width": 160, "height": 120, "intrinsics": camera.intrinsics, "range": camera.range, "frames": frames}
    (made / "camera.json").write_text(json.dumps(told | {"floor": camera.floor}))
    return made


def test_a_world_is_drawn_and_scored(tmp_path):
    done = experiments("--world", "paper_room_open", "--frames", 3, "--out", tmp_path)
    assert done.returncode == 0, done.stdout + done.stderr
    for picture in ("depth", "points", "scans"):
        with Image.open(tmp_path / f"paper_room_open_{picture}.png") as written:
            assert min(written.size) > 400
    table = {scan: list(map(number, cells)) for world, scan, *cells in rows(tmp_path / "edges.md")}
    assert list(table) == [*SCANS, "fused"]
    for scan, (median, percentile95, missed, late, false) in table.items():
        assert -0.1 < median <= percentile95 < 4.0, scan
        assert false < 2.0, scan
        assert missed + late <= 100.0, scan
        assert scan in done.stdout
    farthest_point, virtual_floor, paper = (table[scan] for scan in SCANS[:3])
    for ours in ("near_edge", "fused"):  # by default fused holds none of the paper's methods
        assert table[ours][1] < 0.05  # [m]
        assert table[ours][2:] == [0.0, 0.0, 0.0]  # none missed, late or false
    assert paper[3] <= min(farthest_point[3] + farthest_point[2], virtual_floor[3] + virtual_floor[2]) + 0.1


def test_a_depth_folder_is_drawn_and_counted_and_what_is_bad_left_out(tmp_path, folder):
    done = experiments("--data", folder, "--out", tmp_path / "out")
    assert done.returncode == 0, done.stdout + done.stderr
    assert "leaving out broken.png" in done.stdout
    pictures = sorted(path.name for path in (tmp_path / "out").glob("*.png"))
    assert pictures == ["recording_high.png", "recording_low.png"]
    table = {scan: cells for scan, *cells in rows(tmp_path / "out" / "recording.md")}
    assert list(table) == [*SCANS, "positive", "fused"]
    for cells in table.values():
        assert sum(map(number, cells[:3])) == pytest.approx(100.0, abs=0.2)
    for method in ("virtual_floor", "near_edge"):
        assert 20.0 < number(table[method][0]) < 80.0  # the hole, not the floor beside it
        assert 1.4 < number(table[method][3]) < 2.5
    assert number(table["positive"][0]) > 95.0  # the wall
    assert 4.8 < number(table["positive"][3]) < 5.8


def refused(*words):
    """What is said at the end of a demo that cannot begin."""
    done = forked.ask("experiments", *words, timeout=DEADLINE)
    assert done.returncode == 2
    assert "Traceback" not in done.stderr
    return done.stderr


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--data", "nowhere-at-all"], "demo: nowhere-at-all/camera.json: No such file or directory"),
        (["--world", "nowhere"], "demo: no world is named 'nowhere'"),
        (["--set", "scan.floor_band=no"], "demo: scan.floor_band: "),
    ],
)
def test_what_cannot_be_done_is_one_line_and_exit_2(tmp_path, words, said):
    assert said in refused(*words, "--out", tmp_path)


def test_a_setting_that_a_service_refuses_is_said_in_one_line(tmp_path):
    words = ("--world", "paper_room", "--frames", 1, "--set", "fuse.timeout=-1", "--out", tmp_path)
    assert refused(*words) == "demo: fuse.timeout: Input should be greater than 0\n"


@pytest.fixture
def long_run(tmp_path):
    """The demo on its way to more frames than anyone waits for, its log, and what it started; killed at the end."""
    log = tmp_path / "services.log"
    log.touch()
    words = command("--world", "paper_room", "--frames", 100_000, "--out", tmp_path)
    process = psutil.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, start_new_session=True)
    follow = ["tail", "--follow", "--lines=+1", f"--pid={process.pid}", log]
    with subprocess.Popen(follow, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True) as tail:
        assert any("capture is ready" in line for line in tail.stdout), process.communicate()
        tail.terminate()
    started = process.children(recursive=True)
    yield process, log, started
    for each in (*started, process):
        if each.is_running():
            each.kill()
    process.communicate()


def test_ctrl_c_ends_everything(long_run):
    process, _, started = long_run
    os.killpg(process.pid, signal.SIGINT)
    _, stderr = process.communicate(timeout=DEADLINE)
    assert process.returncode == 130
    assert stderr == "demo: interrupted; everything has been ended\n"
    assert len(started) == 5
    assert not any(each.is_running() for each in started)


def test_a_service_that_dies_ends_everything_with_exit_1(long_run):
    process, log, started = long_run
    next(each for each in started if "cliffscan.services.positive" in each.cmdline()).kill()
    stdout, stderr = process.communicate(timeout=DEADLINE)
    assert process.returncode == 1
    assert f"demo: positive died; everything has been ended; the services' own words: {log}" in stderr
    assert "positive ended (signal 9)" in stdout
    assert not any(each.is_running() for each in started)


@pytest.mark.slow
def test_the_page_stays_open_on_the_drive(folder, tmp_path):
    port = free_port()
    words = command("--data", folder, "--out", tmp_path / "out", "--view", port)
    with subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True) as demo:
        lines = iter(demo.stdout.readline, "")
        assert any(line == f"cliffscan view: http://127.0.0.1:{port}/\n" for line in lines)
        demo.send_signal(signal.SIGINT)
        said = "".join(lines)
        assert demo.wait(PATIENCE) == 0, said
    assert "Traceback" not in said
