"""What one frame freed is there for the next: no page comes again from the system."""

import ctypes
import subprocess
import sys

import pytest

FRAMES = """
import resource
import numpy as np
from cliffscan.common.runtime.kept_memory import keep_freed_memory
if {kept}:
    keep_freed_memory()

def frame():
    arrays = [np.ones(300_000) for _ in range(4)]  # 2.4 MB each

frame()
frame()
before = resource.getrusage(resource.RUSAGE_SELF).ru_minflt
for _ in range(20):
    frame()
print((resource.getrusage(resource.RUSAGE_SELF).ru_minflt - before) // 20)
"""


def faults(kept):
    """Pages that each frame takes from the system."""
    return int(subprocess.check_output([sys.executable, "-c", FRAMES.format(kept=kept)]))


@pytest.mark.skipif(not hasattr(ctypes.CDLL(None), "mallopt"), reason="glibc alone has mallopt")
def test_a_frame_takes_no_page_from_the_system():
    assert faults(kept=False) > 1000
    assert faults(kept=True) < 50
