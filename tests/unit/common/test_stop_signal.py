"""A process that is asked to end does, whatever it does at that moment."""

import subprocess
import sys
import threading

from cliffscan.common.runtime.stop_signal import StopSignal

DEADLINE = 60.0  # [s]
EVERY_STEP = """
import signal
import sys

from cliffscan.common.runtime.stop_signal import StopSignal


def asked(at):
    steps = 0

    def step(frame, event, argument):
        nonlocal steps
        steps += 1
        if steps == at:
            signal.raise_signal(signal.SIGTERM)
        frame.f_trace_opcodes = True
        return step

    stop = StopSignal()
    sys.settrace(step)
    stop.wait(0.001)
    sys.settrace(None)
    assert stop.is_set() == stop.wait(0.0) == (steps >= at)
    return stop.is_set()


at = 1
while asked(at):
    at += 1
print(at)
"""


def test_a_signal_at_any_step_of_waiting_is_heard():
    done = subprocess.run(  # which hangs where a lock is taken twice
        [sys.executable, "-c", EVERY_STEP], timeout=DEADLINE, capture_output=True, text=True, check=False
    )
    assert (done.returncode, done.stderr) == (0, "")
    assert int(done.stdout) > 10


def test_all_who_wait_are_woken():
    stop = StopSignal()
    assert not stop.wait(0.0)
    assert not stop.wait(-1.0)
    waiting = [threading.Thread(target=stop.wait, daemon=True) for _ in range(3)]
    for each in waiting:
        each.start()
    stop.set()
    for each in waiting:
        each.join(DEADLINE)
        assert not each.is_alive()
    assert stop.wait()
