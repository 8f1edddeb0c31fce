"""`cliffscan view` beside a client that publishes what a robot does."""

import re
import subprocess
import sys

import pytest

from tests.service.conftest import DEADLINE, Client
from tests.service.kobuki.conftest import base  # noqa: F401 - a gate that decides


class View:
    """The process, its address, and what it says."""

    def __init__(self, *options) -> None:
        words = [sys.executable, "-m", "cliffscan", "view", "--port", "0", *options]
        self.process = subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self.address = re.fullmatch(r"cliffscan view: (http://.*)\n", self.process.stdout.readline())[1]
        self.port = int(re.search(r":(\d+)/", self.address)[1])

    def end(self):
        """It ends with 0 when told to, and has never fallen over."""
        self.process.terminate()
        _, said = self.process.communicate(timeout=DEADLINE)
        assert self.process.returncode == 0, said
        assert "Traceback" not in said, said


def beside(client):
    """The process on a client's router."""
    return View("--robot", client.robot, "--mode", "client", "--connect", client.endpoint)


@pytest.fixture
def view(client):
    made = beside(client)
    yield made
    made.end()


@pytest.fixture(scope="module")
def network():
    """A router, and the process on it, for tests that have a robot of their own."""
    client = Client()
    client.view = beside(client)
    yield client
    client.view.end()
    client.session.close()
