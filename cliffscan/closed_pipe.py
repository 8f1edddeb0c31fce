"""A command whose output goes to a program that has read enough and ended, as in `cliffscan echo KEY | head -1`."""

import os
import signal
import sys
from collections.abc import Iterator
from contextlib import contextmanager

CODE = 128 + signal.SIGPIPE  # of a program that the signal ends


@contextmanager
def quiet_where_nobody_reads() -> Iterator[None]:
    """End the process without a word where what it prints is read no more. SIGPIPE itself would end it at once.

    What is still to be printed is printed here, for at its own end Python could only complain.
    """
    try:
        try:
            yield
        finally:
            sys.stdout.flush()
    except BrokenPipeError:
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, sys.stdout.fileno())
        sys.exit(CODE)
