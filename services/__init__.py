"""The services: one folder, one process, one idea each; only perception imports others, for it is three of them."""

import os
import signal
import sys

if sys.argv[0] == "-m":  # this process is to be a service, but has not imported it yet: until then it ends at once
    for number in (signal.SIGTERM, signal.SIGINT):
        signal.signal(number, lambda *_: os._exit(0))
