"""Real processes on a private router, and a client that knows nothing but the contract."""

import contextlib
import copy
import itertools
import json
import os
import queue
import runpy
import signal
import socket
import subprocess
import sys
import threading
import time
import uuid

import msgpack
import numpy as np
import pytest
import zenoh

from tests.forked import Forked

DEADLINE = 60.0  # [s] after which a fact that did not come will not come


# Of this process alone among those of one run, and below those that a system gives to whoever connects: what is free
# now still is when a service listens on it.
PORTS = itertools.cycle(range(first := 10_000 + 100 * (os.getpid() % 200), first + 100))


def free_port():
    """A port that nobody listens on."""
    for port in PORTS:
        with contextlib.suppress(OSError), socket.create_server(("127.0.0.1", port)):
            return port
    raise AssertionError


def free_endpoint():
    """An endpoint that nobody listens on."""
    return f"tcp/127.0.0.1:{free_port()}"


def wait_until(holds):
    """Wait for a fact that can only be asked for."""
    deadline = time.monotonic() + DEADLINE
    while not holds():
        assert time.monotonic() < deadline
        threading.Event().wait(0.01)


def open_router():
    """A router of our own and its endpoint."""
    endpoint = free_endpoint()
    config = zenoh.Config()
    for key, value in (
        ("mode", '"router"'),
        ("listen/endpoints", f'["{endpoint}"]'),
        ("scouting/multicast/enabled", "false"),
    ):
        config.insert_json5(key, value)
    return zenoh.open(config), endpoint


class Client:
    """A program of somebody else's: plain Zenoh and msgpack."""

    def __init__(self) -> None:
        self.session, self.endpoint = open_router()
        self._meet()

    def another(self, robot=None):
        """A client of another robot on the same router."""
        other = copy.copy(self)
        other._meet(robot)
        return other

    def _meet(self, robot=None):
        self.robot = robot or f"robot-{uuid.uuid4().hex[:12]}"
        self._alive = {}
        self._changed = threading.Condition()
        self.session.liveliness().declare_subscriber(f"{self.robot}/alive/*", self._token, history=True)

    def _token(self, sample):
        with self._changed:
            self._alive[str(sample.key_expr).rpartition("/")[2]] = sample.kind == zenoh.SampleKind.PUT
            self._changed.notify_all()

    def wait_alive(self, service, alive=True):
        with self._changed:
            assert self._changed.wait_for(lambda: self._alive.get(service, False) == alive, DEADLINE), service

    def wait_subscribed(self, path):
        """Wait until the router knows that somebody subscribes."""
        publisher = self.session.declare_publisher(f"{self.robot}/{path}")
        wait_until(lambda: publisher.matching_status.matching)
        publisher.undeclare()

    def put(self, path, message):
        payload = message if isinstance(message, bytes) else msgpack.packb(message)
        self.session.put(f"{self.robot}/{path}", payload, congestion_control=zenoh.CongestionControl.BLOCK)

    def ask(self, path, parameters):
        """The answer to a request."""
        replies = self.session.get(f"{self.robot}/{path}", payload=msgpack.packb(parameters), timeout=DEADLINE)
        return next(msgpack.unpackb(reply.ok.payload.to_bytes()) for reply in replies)

    def listen(self, path):
        return Ear(self.session, f"{self.robot}/{path}")


class Ear:
    """What is said on a key, in order."""

    def __init__(self, session, key) -> None:
        self._heard = queue.Queue()
        self._subscriber = session.declare_subscriber(
            key, lambda sample: self._heard.put((str(sample.encoding), msgpack.unpackb(sample.payload.to_bytes())))
        )

    def get(self):
        """The next message."""
        return self._heard.get(timeout=DEADLINE)[1]

    def get_within(self, seconds):
        """The next message, or None where none comes so soon."""
        with contextlib.suppress(queue.Empty):
            return self._heard.get(timeout=seconds)[1]

    def encoding(self):
        return self._heard.get(timeout=DEADLINE)[0]

    def until(self, holds):
        """The first message of which `holds` is true."""
        while True:
            message = self.get()
            if holds(message):
                return message

    def all(self):
        """All that was said and not yet read."""
        messages = []
        with contextlib.suppress(queue.Empty):
            while True:
                messages.append(self._heard.get_nowait()[1])
        return messages


def ranges(scan):
    return np.frombuffer(scan["ranges"], "<f4")


def intensities(scan):
    return np.frombuffer(scan["intensities"], "<f4")


def image(camera, depth, stamp, seq=0, **changes):
    """A raw DepthImage as the contract has it."""
    fields = {
        "seq": seq,
        "stamp": stamp,
        "frame": "somewhere",
        "width": camera.width,
        "height": camera.height,
        "encoding": "16UC1",
        "data": depth.astype("<u2").tobytes(),
        "intrinsics": list(camera.intrinsics),
        "range": list(camera.range),
        "floor": list(camera.floor),
    }
    return fields | changes


def scan(values, stamp, seq=0, **changes):
    """A LaserScan as the contract has it."""
    fields = {
        "seq": seq,
        "stamp": stamp,
        "frame": "camera_footprint",
        "angle_min": -0.5,
        "angle_max": 0.5,
        "angle_increment": 1.0 / (len(values) - 1),
        "time_increment": 0.0,
        "scan_time": 0.033,
        "range_min": 0.0,
        "range_max": 10.0,
        "ranges": np.asarray(values, "<f4").tobytes(),
        "intensities": b"",
    }
    return fields | changes


@pytest.fixture
def meeting_point(tmp_path):
    """A Zenoh file for those who look for each other without an endpoint: where no other test's router answers."""
    file = tmp_path / "zenoh.json5"
    multicast = {"enabled": True, "interface": "lo", "address": f"224.0.0.224:{free_port()}"}
    file.write_text(json.dumps({"scouting": {"multicast": multicast}}))
    return file


@pytest.fixture
def client():
    made = Client()
    yield made
    made.session.close()


class Running:
    """A process and what it says on its standard error; `fresh`: not by fork. With an environment it always is."""

    def __init__(self, command, fresh=False, **environment) -> None:
        said, saying = os.pipe()
        if command[:2] == [sys.executable, "-m"] and not fresh and not environment:
            self.process = Forked(command[2:], [0, 1, saying])
        else:
            self.process = subprocess.Popen(command, env=os.environ | environment, stderr=saying)
        os.close(saying)
        self._stderr = open(said)  # noqa: SIM115, PTH123 - closed by its reader
        self.said = ""
        self.expected = 0
        self._heard = threading.Condition()
        self._reader = threading.Thread(target=self._read, daemon=True)
        self._reader.start()

    def _read(self):
        with self._stderr:
            for line in self._stderr:
                with self._heard:
                    self.said += line
                    self._heard.notify_all()

    def wait_said(self, words):
        with self._heard:
            assert self._heard.wait_for(lambda: words in self.said, DEADLINE), self.said

    def signal(self, number):
        if self.process.poll() is None:
            self.process.send_signal(number)

    def end(self):
        """Its exit code, when it has ended; it must never have fallen over."""
        code = self.process.wait(DEADLINE)
        self._reader.join(DEADLINE)
        assert "Traceback" not in self.said, self.said
        return code


@pytest.fixture
def ask_here(monkeypatch, capsys):
    """What `python -m MODULE OPTIONS` prints and how it ends, in this process: for what ends before anything starts."""

    def ask(module, *options):
        monkeypatch.setattr(sys, "argv", [module, *options])
        with pytest.raises(SystemExit) as ended:
            runpy.run_module(module, run_name="__main__", alter_sys=True)
        printed = capsys.readouterr()
        return subprocess.CompletedProcess(options, ended.value.code or 0, printed.out, printed.err)

    return ask


@contextlib.contextmanager
def repeated(work, period):
    """Do this over and over meanwhile, with a pause of so many seconds."""
    ended = threading.Event()

    def run():
        while not ended.wait(period):
            work()

    thread = threading.Thread(target=run)
    thread.start()
    try:
        yield
    finally:
        ended.set()
        thread.join()


@pytest.fixture
def run():
    """Start processes; at the end each must leave as expected, by default with 0, when told to."""
    running = []

    def begin(command, **how):
        running.append(Running(command, **how))
        return running[-1]

    yield begin
    for process in running:
        process.signal(signal.SIGTERM)
        process.signal(signal.SIGCONT)  # it may have been stopped
    try:
        for process in running:
            assert process.end() == process.expected, process.said
    finally:
        for process in running:
            process.signal(signal.SIGKILL)


@pytest.fixture
def start(client, run):
    """Start a service and wait until it is ready."""

    def begin(service, *options, wait=True, where=None, robots=None, **how):
        place = ["--connect", client.endpoint] if where is None else where
        names = [word for robot in robots or [client.robot] for word in ("--robot", robot)]
        process = run([sys.executable, "-m", f"services.{service}", *names, *place, *options], **how)
        if wait:
            client.wait_alive(service)
        return process

    return begin
