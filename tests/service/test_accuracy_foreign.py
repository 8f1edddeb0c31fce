"""The accuracy benchmark scores a program of somebody else's, and has a clear line for one that cannot be scored."""

import sys
from pathlib import Path

import numpy as np
import pytest

from benchmarks.accuracy import __main__ as accuracy
from benchmarks.accuracy import foreign
from benchmarks.accuracy.cases import Case
from benchmarks.accuracy.foreign import ForeignError, ForeignProgram, at_angles
from benchmarks.accuracy.frames import KNOWN, frames_of
from benchmarks.accuracy.measure import measure
from benchmarks.accuracy.scans import ANGLES, beams_of
from cliffscan.common.contract.messages import LaserScan

REAL = Path(__file__).parents[1] / "data" / "real"
PROGRAM = """\
import os, sys, threading
import msgpack, numpy, zenoh
robot, endpoint, how = os.environ["CLIFFSCAN_ROBOT"], sys.argv[1], sys.argv[2]
config = zenoh.Config.from_json5('{mode: "client", connect: {endpoints: ["%s"]}}' % endpoint)
session = zenoh.open(config)
def receive(sample):
    image = msgpack.unpackb(sample.payload.to_bytes())
    millimetres = numpy.frombuffer(image["data"], "<u2").reshape(image["height"], image["width"])
    ranges = numpy.full(10, 2.5 if millimetres.any() else numpy.inf, "<f4")
    ranges[0] = numpy.nan
    scan = dict(seq=0, stamp=image["stamp"], frame="mine", angle_min=-0.45, angle_max=0.45, angle_increment=0.1,
                time_increment=0.0, scan_time=0.0, range_min=0.0, range_max=4.0,
                ranges=ranges.tobytes(), intensities=b"")
    scan |= dict(stamp=1) if how == "stamps" else dict(ranges=b"123") if how == "rubbish" else {}
    if how == "once" and image["seq"] or how == "silent":
        return
    session.put(robot + "/scan/mine", msgpack.packb(scan))
subscription = session.declare_subscriber(robot + "/camera/depth", receive) if how != "deaf" else None
threading.Event().wait()
"""
FRAME = next(frames_of(Case("kerb", 1), KNOWN))


@pytest.fixture
def command(tmp_path):
    path = tmp_path / "mine.py"
    path.write_text(PROGRAM)
    return lambda how: f"'{sys.executable}' '{path}' {{endpoint}} {how}"


def test_a_small_program_is_scored_beside_our_methods(command):
    case = Case("kerb_5cm", 3)
    with ForeignProgram(command("well"), "scan/mine") as program:
        others = {program.path: lambda frame: program.beams(frame, ANGLES)}
        table = measure([case, Case("open_floor", 3)], ["near_edge"], others=others)
    assert table.figures("scan/mine").false_safe == pytest.approx(0.8, abs=0.1)  # nine of ten beams, most of the grid
    assert table.figures("scan/mine").found == 0.0  # 2.5 m is beyond a kerb within 1.5 m
    assert table.figures("scan/mine").late > 0.8
    assert table.figures("near_edge").found > 0.9
    assert f"answered {program.asked} of {program.asked} frames" in program.note


def test_our_own_service_comes_to_what_it_comes_to_in_process():
    command = f"'{sys.executable}' -m services.negative --robot {{robot}} --mode client --connect {{endpoint}}"
    with ForeignProgram(command, "scan/negative/near_edge") as program:
        told = program.beams(FRAME, ANGLES)
    ours = beams_of(FRAME, ["near_edge"])["near_edge"]
    assert np.array_equal(told.ranges, ours.ranges, equal_nan=True)
    assert np.array_equal(told.clear, ours.clear)


@pytest.mark.parametrize(
    ("how", "line"),
    [
        ("silent", "no scan with the stamp of an image came at scan/mine within 1 s$"),
        ("stamps", "no scan with the stamp of an image .*; [1-9][0-9]* scans had another stamp"),
        ("rubbish", "what it publishes at scan/mine is no LaserScan: ranges"),
        ("deaf", "it has not subscribed to camera/depth of its robot within 0.5 s"),
    ],
)
def test_a_program_that_does_not_answer_well_has_a_line(command, how, line, monkeypatch):
    monkeypatch.setattr(foreign, "STARTING", 0.5 if how == "deaf" else foreign.STARTING)
    monkeypatch.setattr(foreign, "FIRST", {"silent": 1.0, "stamps": 5.0}.get(how, foreign.FIRST))
    with pytest.raises(ForeignError, match=line), ForeignProgram(command(how), "scan/mine") as program:
        program.beams(FRAME, ANGLES)


def test_a_program_that_falls_silent_has_not_seen_and_in_the_end_a_line(command):
    with ForeignProgram(command("once"), "scan/mine", deadline=0.2) as program:
        assert np.isfinite(program.beams(FRAME, ANGLES).ranges).any()
        for _ in range(foreign.MOST_SILENT - 1):
            assert np.isnan(program.beams(FRAME, ANGLES).ranges).all()
        with pytest.raises(ForeignError, match=r"no scan of 5 images in turn within 0\.2 s; it answered 1 of 6"):
            program.beams(FRAME, ANGLES)


@pytest.mark.parametrize(
    ("command", "line"),
    [
        ("false", "it ended by itself with exit code 1"),
        ("no-such-program-anywhere", "it does not start: No such file"),
        ("'half a quote", "quote the command as a shell would"),
        (" ", "an empty command"),
    ],
)
def test_a_program_that_does_not_run_has_a_line(command, line):
    with pytest.raises(ForeignError, match=line), ForeignProgram(command, "scan/mine") as program:
        program.beams(FRAME, ANGLES)


def run(monkeypatch, *options):
    monkeypatch.setattr(sys, "argv", ["accuracy", *map(str, options)])
    accuracy.main()


def test_from_the_command_line_it_is_one_table_of_scenes_and_frames(command, monkeypatch, tmp_path, capsys):
    folder = REAL / "cape_tunnel"
    given = ("--foreign", command("well"), "--key", "scan/mine", "--frames", folder)
    run(monkeypatch, "--scenes", 0, "--methods", "near_edge", "--out", tmp_path, *given)
    text = (tmp_path / "accuracy.md").read_text()
    assert f"## {folder.name}" in text
    assert [line.split("|")[1].strip() for line in text.splitlines() if "%" in line and line[0] == "|"] == [
        "near_edge",
        "scan/mine",
    ]
    assert "`scan/mine` is" in text


def test_a_program_that_cannot_be_scored_is_one_line_and_exit_2(monkeypatch, tmp_path, capsys):
    with pytest.raises(SystemExit) as ended:
        run(monkeypatch, "--scenes", 2, "--out", tmp_path, "--foreign", "false", "--key", "scan/mine")
    assert ended.value.code == 2
    assert capsys.readouterr().err == "false: it ended by itself with exit code 1; its own lines, if any, are above\n"
    with pytest.raises(SystemExit):
        run(monkeypatch, "--foreign", "false")
    assert "--key" in capsys.readouterr().err


def test_the_nearest_beam_counts_and_none_beyond_the_grid_of_the_program():
    ranges = np.array([1.0, 2.0, 3.0, 4.0], np.float32)
    header = {"seq": 0, "stamp": 1, "frame": "", "time_increment": 0.0, "scan_time": 0.0, "range_min": 0.0}
    header["range_max"] = 9.0
    quarter = LaserScan(
        **header, angle_min=0.0, angle_max=1.5 * np.pi, angle_increment=np.pi / 2, ranges=ranges, intensities=ranges[:0]
    )
    assert at_angles(quarter, np.radians([-80.0, -10.0, 10.0, 80.0])).ranges.tolist() == [4.0, 1.0, 1.0, 2.0]
    narrow = LaserScan(
        **header, angle_min=-0.15, angle_max=0.15, angle_increment=0.1, ranges=ranges, intensities=ranges[:0]
    )
    told = at_angles(narrow, np.array([-0.21, -0.19, 0.0, 0.19, 0.21])).ranges
    assert np.isnan(told).tolist() == [True, False, False, False, True]
