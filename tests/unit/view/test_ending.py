"""The page's process ends when it is told to, whatever its viewers do."""

import subprocess
import sys

DEADLINE = 60.0  # [s]
STALLED = """
import threading

from cliffscan.common.runtime.network import Network
from cliffscan.common.runtime.stop_signal import StopSignal
from cliffscan.view import command


class Server:
    \"\"\"Has a viewer that takes nothing, so that the thread which sends to it waits for ever.\"\"\"

    port = 1

    def __init__(self, *_):
        threading.Thread(target=threading.Event().wait).start()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        pass


command.Server = Server
stop = StopSignal()
stop.set()
command.view(Network(), "turtlebot", "here", "127.0.0.1", 0, (), stop)
"""


def test_a_viewer_that_takes_nothing_does_not_keep_it_from_ending():
    done = subprocess.run([sys.executable, "-c", STALLED], capture_output=True, text=True, timeout=DEADLINE)
    assert (done.returncode, done.stdout, done.stderr) == (0, "cliffscan view: http://127.0.0.1:1/\n", "")
