"""Kernels are compiled before a service is alive, and none when frames come."""

import subprocess
import sys


def test_no_frame_makes_a_service_compile():
    command = [sys.executable, "-m", "tests.compiled_by_frames"]  # here other tests have compiled before
    count, *compiled = subprocess.run(command, check=True, capture_output=True, text=True).stdout.split()
    assert int(count) > 20
    assert compiled == []
