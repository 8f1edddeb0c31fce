"""`cliffscan` after a login: python -m tests.login TERMINAL ...

The terminal controls the session that it is opened in, and hangs it up; no signal is ignored, as it is below a shell's
background job.
"""

import os
import runpy
import signal
import sys

if __name__ == "__main__":
    for number in (signal.SIGQUIT, signal.SIGHUP):
        signal.signal(number, signal.SIG_DFL)
    os.setsid()
    terminal = os.open(sys.argv[1], os.O_RDWR)
    for stream in (0, 1):
        os.dup2(terminal, stream)
    sys.argv = ["cliffscan", *sys.argv[2:]]
    runpy.run_module("cliffscan", run_name="__main__", alter_sys=True)
