"""The paper's experiments (section Experiment, figures 11 to 22) through the real services, or those of a recording."""

import signal

signal.signal(signal.SIGINT, signal.SIG_DFL)  # while modules load, Ctrl-C ends this without a traceback

from experiments.cli import main  # noqa: E402

main()
