"""A real Chromium, driven by its DevTools protocol over a socket."""

import json
import re
import shutil
import subprocess
import time
import urllib.request
from contextlib import ExitStack

import pytest
from websockets.sync.client import connect

DEADLINE = 60.0  # [s]
FLAGS = [
    "--headless",
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--remote-debugging-port=0",
]
ADDRESS = re.compile(r"DevTools listening on ws://([\d.:]+)/")


class Chromium:
    """One page in a browser of its own. Skips the test where the system package `chromium` is missing."""

    def __init__(self, folder) -> None:
        program = shutil.which("chromium")
        if program is None:
            pytest.skip("the system package chromium is missing: apt-get install chromium")
        words = [program, *FLAGS, f"--user-data-dir={folder}", "about:blank"]
        self._process = subprocess.Popen(words, stderr=subprocess.PIPE, text=True)
        found = next(filter(None, map(ADDRESS.search, self._process.stderr)))
        with urllib.request.urlopen(f"http://{found[1]}/json", timeout=DEADLINE) as answer:
            page = next(each for each in json.load(answer) if each["type"] == "page")
        self._exit = ExitStack()
        self._socket = self._exit.enter_context(connect(page["webSocketDebuggerUrl"], max_size=None, compression=None))
        self._number = 0
        self.errors = []  # what went wrong in the page
        for domain in ("Page", "Runtime", "Log"):
            self.call(f"{domain}.enable")

    def call(self, method, **parameters):
        """What a method of the protocol returns."""
        self._number += 1
        self._socket.send(json.dumps({"id": self._number, "method": method, "params": parameters}))
        while True:
            message = json.loads(self._socket.recv(timeout=DEADLINE))
            if message.get("id") == self._number:
                assert "error" not in message, message
                return message["result"]
            if message["method"] in ("Runtime.exceptionThrown", "Log.entryAdded"):
                self.errors.append(message["params"])

    def value(self, expression):
        """What an expression is in the page."""
        return self.call("Runtime.evaluate", expression=expression, returnByValue=True)["result"].get("value")

    def until(self, expression, meanwhile=lambda: None):
        """Wait until an expression holds in the page."""
        deadline = time.monotonic() + DEADLINE
        while not self.value(expression):
            assert time.monotonic() < deadline, (expression, self.value("document.body.innerText"), self.errors)
            meanwhile()

    def close(self):
        self._exit.close()
        self._process.terminate()
        self._process.wait(DEADLINE)
        self._process.stderr.close()
