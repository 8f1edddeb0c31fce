"""`python -m MODULE` by fork, from a process that has loaded what all of them load: that takes longer than most tests.

What is started here has its own arguments, environment, standard streams, signals and end, as any other process has.
"""

import atexit
import functools
import gc
import importlib
import json
import os
import runpy
import select
import signal
import socket
import subprocess
import sys
from contextlib import suppress

LOADED = ["cliffscan.cli", "cliffscan.common.runtime.service"]
LARGEST = 1 << 20  # [bytes] of a request
FILES = 4  # of a request: where it is answered, and the streams
NUMBER = 4  # [bytes] of an answer


class Forked:
    """What of subprocess.Popen the tests use. words: MODULE and its arguments; streams: file numbers 0, 1 and 2."""

    def __init__(self, words, streams) -> None:
        self.returncode = None
        self._words = words
        answers, answering = os.pipe()
        request = json.dumps([list(map(str, words)), dict(os.environ)]).encode()
        socket.send_fds(_forker(), [request], [answering, *streams])
        os.close(answering)
        self._answers = open(answers, "rb", buffering=0)  # noqa: SIM115, PTH123
        self.pid = self._number()

    def _number(self):
        told = self._answers.read(NUMBER)
        assert told, "the forking process is gone"
        return int.from_bytes(told, "little", signed=True)

    def wait(self, timeout):
        """The exit code. Raises TimeoutExpired."""
        if self.returncode is None:
            if not select.select([self._answers], [], [], timeout)[0]:
                raise subprocess.TimeoutExpired(self._words, timeout)
            self.returncode = self._number()
            self._answers.close()
        return self.returncode

    def poll(self):
        """The exit code, None while it runs."""
        with suppress(subprocess.TimeoutExpired):
            self.wait(0.0)
        return self.returncode

    def send_signal(self, number):
        """Send a signal to it, if it runs."""
        if self.poll() is None:
            os.kill(self.pid, number)

    def terminate(self):
        """Ask it to end."""
        self.send_signal(signal.SIGTERM)


def ask(*words, answer="", timeout):
    """What `python -m MODULE ...` prints, with its exit code, as subprocess.run returns it."""
    with open_memory(answer) as given, open_memory() as out, open_memory() as err:
        code = Forked(words, [file.fileno() for file in (given, out, err)]).wait(timeout)
        for file in (out, err):
            file.seek(0)
        return subprocess.CompletedProcess(words, code, out.read(), err.read())


def open_memory(text=""):
    """A file that is nowhere, with some text in it."""
    file = open(os.memfd_create("stream"), "w+")  # noqa: SIM115, PTH123
    file.write(text)
    file.seek(0)
    return file


@functools.cache
def _forker():
    """The socket of this process's forking process, which ends with it."""
    ours, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
    command = [sys.executable, "-m", "tests.forked", str(theirs.fileno())]
    process = subprocess.Popen(command, pass_fds=[theirs.fileno()])
    theirs.close()

    def end():
        ours.close()
        process.wait()

    atexit.register(end)
    return ours


def serve(requests):
    """Fork for each request until nobody can make one any more; returns the words that a forked process has to run."""
    while True:
        request, files, _, _ = socket.recv_fds(requests, LARGEST, FILES)
        if not request:
            sys.exit()
        if os.fork() == 0:
            requests.close()
            words, environment = json.loads(request)
            watched(*files)
            os.environ.clear()
            os.environ.update(environment)
            return words
        for file in files:
            os.close(file)
        while reap():
            pass


def reap():
    """Whether a forked process that has ended was waited for."""
    with suppress(ChildProcessError):
        return os.waitpid(-1, os.WNOHANG)[0] != 0
    return False


def watched(answering, *streams):
    """Fork once more: the one process tells the other's number and its exit code, the other returns."""
    pid = os.fork()
    if pid:
        for file in streams:
            os.close(file)
        tell(answering, pid)
        tell(answering, os.waitstatus_to_exitcode(os.waitpid(pid, 0)[1]))
        os._exit(0)
    os.close(answering)
    for number, file in enumerate(streams):
        os.dup2(file, number)
        os.close(file)


def tell(answering, number):
    with suppress(BrokenPipeError):
        os.write(answering, number.to_bytes(NUMBER, "little", signed=True))


def load():
    """Load modules and compiled kernels."""
    for name in LOADED:
        importlib.import_module(name)
    importlib.import_module("tests.compile").compile_kernels()  # which who only asks for a process need not load
    gc.freeze()  # or each process would copy all there is as it looks for garbage


if __name__ == "__main__":
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is for those who ask
    load()
    module, *arguments = serve(socket.socket(fileno=int(sys.argv[1])))
    signal.signal(signal.SIGINT, signal.default_int_handler)
    sys.argv = [module, *arguments]
    runpy.run_module(module, run_name="__main__", alter_sys=True)
