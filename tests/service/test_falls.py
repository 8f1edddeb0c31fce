"""A robot wanders through a random world by the real services, and nothing happens to it."""

import csv
import subprocess
import sys

import pytest

PATIENCE = 150  # [s] for kernels that have never been compiled


def falls(*words):
    command = [sys.executable, "-m", "benchmarks.falls", "--processes", *map(str, words)]
    return subprocess.run(command, capture_output=True, text=True, timeout=PATIENCE, check=False)


@pytest.mark.slow
def test_a_robot_wanders_and_does_not_fall(tmp_path):
    short = ("--worlds", 1, "--seed", 20, "--speeds", 0.5, "--minutes", 0.15)
    done = falls("--modes", "default", *short, "--out", tmp_path)
    assert done.returncode == 0, done.stdout + done.stderr
    with (tmp_path / "runs.csv").open() as file:
        (run,) = csv.DictReader(file)
    assert run["case"] == "default:0.5:20"
    assert float(run["seconds"]) == pytest.approx(9.0, abs=1.0)
    assert (run["fall"], run["cliff"]) == ("0", "0")
    assert float(run["visited"]) * float(run["area"]) > 0.5  # [m²]: more than where it began
    assert "published" in (tmp_path / "default-0.5-20.log").read_text()


def test_a_mode_without_services_is_refused():
    done = falls("--modes", "positive")
    assert done.returncode == 2
    assert done.stderr.splitlines()[-1].endswith("no services for the mode positive: say --modes default,paper")
