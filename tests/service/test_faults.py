"""A fault while the robot drives towards stairs: it comes to rest, does not fall, and goes on when all is well."""

import subprocess
import sys

import pytest

from tests.service.test_demo import rows

FAULT = "frames frozen"
PATIENCE = 150  # [s] for kernels that have never been compiled


@pytest.mark.slow
def test_the_robot_stops_does_not_fall_and_goes_on(tmp_path):
    words = ["--trials", 1, "--only", FAULT, "--out", tmp_path / "faults.md"]
    command = [sys.executable, "-m", "benchmarks.faults", *map(str, words)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=PATIENCE, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    table = {name: cells for name, *cells in rows(tmp_path / "faults.md")}
    assert set(table) == {FAULT, "all"}
    trials, _, slowest, _, left, fell, went_on, _ = table["all"]
    assert (trials, fell, went_on) == ("1", "0", "1")
    assert float(slowest) < 1.5  # [s] of the simulation
    assert float(left) > 0.0
