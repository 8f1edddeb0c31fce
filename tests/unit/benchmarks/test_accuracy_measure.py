"""The benchmark as a whole: the same figures however it is run, frames as they are said to be, and a report."""

import numpy as np
import pytest

from benchmarks.accuracy.cases import Case, camera_of, scene_of, some_cases
from benchmarks.accuracy.frames import (
    KNOWN,
    PLANES,
    SETTLING,
    UNKNOWN,
    WOBBLE_FRAMES,
    WOBBLING,
    Sensor,
    as_sent,
    frames_of,
)
from benchmarks.accuracy.measure import EVERY, measure
from benchmarks.accuracy.report import report
from benchmarks.accuracy.rows import worst
from benchmarks.accuracy.scans import ANGLES, BEST, all_beams
from benchmarks.accuracy.setups import BUILD, LEVEL, MOUNTED, SETUPS
from cliffscan.simulator.kinect import KinectModel
from evaluation.tables import write_csv
from evaluation.truth.scene_truth import truth_of

SCAN = "virtual_floor"
CASES = some_cases(4, seed=3, setups=(LEVEL, MOUNTED))


def figures(table):
    return [row.record() for row in table.rows]


@pytest.fixture(scope="module")
def table():
    return measure(CASES, [SCAN, "paper"])


def test_same_figures_again_and_in_several_processes(table):
    again = measure(CASES, [SCAN, "paper"], jobs=2)
    assert str(figures(again)) == str(figures(table))


def test_order_of_the_cases_changes_nothing(table):
    turned = measure(CASES[::-1], [SCAN, "paper"])
    assert sorted(map(str, figures(turned))) == sorted(map(str, figures(table)))


def test_report_and_records_name_every_case_and_scan(table, tmp_path):
    text = report(table)
    assert "## Setup level, plane known" in text
    assert all(f"| {scan} |" in text for scan in (SCAN, "paper"))
    write_csv((row.record() for row in table.rows), tmp_path / "cases.csv")
    lines = (tmp_path / "cases.csv").read_text().splitlines()
    assert len(lines) == 1 + 2 * len(CASES)
    assert all(row.plane == KNOWN for row in worst(table.rows, "paper", KNOWN, 3))


def test_all_kinds_are_among_the_cases():
    assert {case.kind for case in some_cases(80, seed=1)} == set(BUILD)
    assert len({case.kind for case in some_cases(400, seed=1)[::EVERY]}) > len(BUILD) // 2


@pytest.mark.parametrize("case", [Case("hole", 12), Case("stairs", 7, "mounted"), Case("ramp_ahead", 3, "ramps")])
def test_name_of_a_case_leads_back_to_it(case):
    assert Case.parse(case.name) == case


@pytest.mark.parametrize("name", ["volcano:1", "airborne-hole:1"])
def test_unknown_case_is_refused(name):
    with pytest.raises(ValueError, match="is no case"):
        Case.parse(name)


def test_each_setup_has_its_cases_and_none_changes_anothers():
    all_of = some_cases(20, seed=5)
    assert {case.group for case in all_of} == set(SETUPS)
    for name in SETUPS:
        assert some_cases(20, seed=5, setups=(name,)) == [case for case in all_of if case.group == name]


def test_a_column_that_no_scan_has_a_figure_for_is_left_out():
    flat = measure(some_cases(4, seed=3, setups=("flat",)), [SCAN])
    headings = next(line for line in report(flat).splitlines() if line.startswith("| scan"))
    assert headings == "| scan | false, safe | blind |"


def test_frames_are_scored_as_a_thin_link_carries_them():
    case = Case("hole", 12)
    (frame,) = frames_of(case, KNOWN)
    assert as_sent(frame, 1) is frame
    sent = as_sent(frame, 3)
    assert (sent.depth.shape[1], sent.camera.width, sent.true) == (213, 213, frame.true)
    whole, thin = (figures(measure([case], [BEST], every=every)) for every in (1, 3))
    assert whole != thin


def test_the_border_returns_nothing_and_is_told():
    (frame,) = frames_of(Case("open_floor", 1, "border"), KNOWN)
    left, top, right, bottom = frame.camera.region
    lost = frame.depth.copy()
    lost[top : bottom + 1, left : right + 1] = 0
    assert frame.camera.seen is not None
    assert not lost.any()
    assert frame.depth[bottom, left : right + 1].any()


def test_known_plane_is_the_true_one():
    (frame,) = frames_of(CASES[0], KNOWN)
    assert frame.camera == frame.true == camera_of(CASES[0])


def test_unknown_plane_is_a_little_off():
    frame = next(frames_of(CASES[0], UNKNOWN))
    tilt = np.degrees(np.arccos(np.dot(frame.camera.floor[:3], frame.true.floor[:3])))
    assert 0.05 < tilt < 3.0
    assert 0.0 < abs(frame.camera.floor.d - frame.true.floor.d) <= 0.01


def test_wobbling_camera_nods_about_the_plane_that_is_said():
    frames = [frame for frame in frames_of(CASES[0], WOBBLING) if frame.plane == WOBBLING]
    nods = [np.degrees(np.arcsin(frame.camera.floor.nz - frame.true.floor.nz)) for frame in frames]
    assert len(frames) == WOBBLE_FRAMES - SETTLING
    assert 1.0 < max(nods) <= 2.0
    assert -2.0 <= min(nods) < -1.0


def test_frames_are_the_same_again():
    for plane in PLANES[:2]:
        one, other = next(frames_of(CASES[1], plane)), next(frames_of(CASES[1], plane))
        assert np.array_equal(one.depth, other.depth)
        assert one.camera == other.camera


@pytest.mark.parametrize("group", ["stereo", "flight"])
def test_a_sensor_has_the_noise_that_its_camera_tells(group):
    (frame,) = frames_of(Case("open_floor", 1, group), KNOWN)
    exact = Sensor(scene_of(Case("open_floor", 1, group)), np.random.default_rng(1), KinectModel()).exact(frame.true)
    near = (frame.depth > 0) & (exact > 0.7) & (exact < 1.2)
    off = 1.0 / (frame.depth[near] * 1e-3) - 1.0 / exact[near]
    assert near.sum() > 1000
    assert off.std() == pytest.approx(frame.camera.noise, rel=0.35)


@pytest.mark.parametrize("seed", [4, 7, 8])
def test_before_a_kerb_of_5_cm_that_stereo_smears_floor_ends(seed):
    case = Case("kerb_5cm", seed, "stereo")
    (frame,) = frames_of(case, KNOWN)
    truth, beams = truth_of(scene_of(case), frame.true, ANGLES), all_beams(frame, [BEST], {})[BEST]
    near = truth.drop & (truth.edge < 1.5)
    assert near.sum() > 200
    assert not (beams.clear[near] > truth.edge[near] + 0.1).any()
    assert np.isfinite(beams.ranges[near]).mean() > 0.95
