"""What nobody reads any more ends a command without a word."""

import os
import signal
import subprocess
import sys

import pytest

DEADLINE = 60.0  # [s]
PRINTS = """
from cliffscan import cli


def prints(arguments, stop):
    print("more", flush={flush})
    return 0


cli.view = prints
cli.main()
"""


@pytest.mark.parametrize("flush", [True, False])
def test_a_command_whose_reader_is_gone_ends_quietly(flush):
    reads, prints = os.pipe()
    os.close(reads)
    command = [sys.executable, "-c", PRINTS.format(flush=flush), "view"]
    done = subprocess.run(command, stdout=prints, stderr=subprocess.PIPE, text=True, timeout=DEADLINE)
    os.close(prints)
    assert (done.returncode, done.stderr) == (128 + signal.SIGPIPE, "")
