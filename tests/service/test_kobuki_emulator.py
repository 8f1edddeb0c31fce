"""The emulated base as a driver meets it: a port that opens, streams, obeys, and fails on demand."""

import contextlib
import os
import signal
import socket
import sys

import pytest
import serial

from cliffscan.simulator.kobuki.client import Remote
from cliffscan.simulator.kobuki.control import ControlError
from tests import forked
from tests.service.conftest import DEADLINE, wait_until
from tests.unit.kobuki_emulator.packets import command, decoded, drive

STOP = drive(0)


class Emulator:
    """A running base, and a driver's end of its cable."""

    def __init__(self, process, link, control) -> None:
        self.process, self.link, self.control = process, link, control
        self.remote = Remote(control, DEADLINE)

    def open(self):
        port = serial.Serial(str(self.link), 115200, timeout=DEADLINE, exclusive=True)
        return contextlib.closing(port)


@pytest.fixture
def emulate(run, tmp_path):
    def begin(*options):
        link, control = tmp_path / "kobuki", tmp_path / "control"
        command_line = [sys.executable, "-m", "simulator.kobuki", "--link", str(link), "--control", str(control)]
        process = run([*command_line, *options])
        process.wait_said("ready")
        return Emulator(process, link, control)

    return begin


def packet(port):
    """The next good packet, decoded, whatever stands before it."""
    while True:
        port.read_until(b"\xaa\x55")
        size = port.read(1)[0]
        payload, check = port.read(size), port.read(1)[0]
        for byte in payload:
            check ^= byte
        if check == size >= 77:
            return decoded(payload)


def wait_packets(base, count):
    """Until the base has sent so many more."""
    sent = base.remote.state()["packets"]
    wait_until(lambda: base.remote.state()["packets"] >= sent + count)


def until(port, holds):
    """The first packet of which `holds` is true."""
    while not holds(told := packet(port)):
        pass
    return told


def test_the_base_streams_in_its_own_time(emulate):
    with emulate().open() as port:
        stamps = [packet(port)["core"]["stamp"] for _ in range(30)]
    assert stamps == [*range(stamps[0], stamps[0] + 600, 20)]


def test_a_driver_that_comes_late_reads_nothing_old(emulate):
    base = emulate()
    with contextlib.closing(base.remote.watch()) as watch:
        with base.open():
            base.remote.tell("garbage 3000")  # which nobody reads
            wait_packets(base, 3)
        next(event for event in watch if event.get("port") == "closed")
    before = base.remote.state()["uptime"]
    port = os.open(base.link, os.O_RDWR | os.O_NOCTTY)  # unlike pyserial, this does not empty its buffer
    fresh = os.read(port, 7)
    os.close(port)
    assert fresh[:5].hex() in ("aa554d010f", "aa5553010f")
    assert int.from_bytes(fresh[5:], "little") >= 1000 * before - 20


def test_the_base_drives_as_told_and_tells_how_far(emulate):
    base = emulate("--dead-time", "0")
    with base.open() as port:
        port.write(drive(200))
        until(port, lambda told: told["core"]["left"] > 1000)
        port.write(STOP)
        rested = until(port, lambda told: told["core"]["left_pwm"] == 0)
    assert base.remote.state()["truth"]["x"] == pytest.approx(rested["core"]["left"] * 0.0000852920904977, abs=0.0001)


def test_commands_may_come_byte_by_byte_among_garbage(emulate):
    base = emulate()
    with base.open() as port:
        for byte in b"\xaa\x55\x01" + command(12, "<H", 0x02F0) + b"\xaa" + command(4, "<B", 4) + command(14, "<B", 0):
            port.write(bytes([byte]))
        until(port, lambda told: "controller" in told)
    state = base.remote.state()
    assert state["output"]["leds"] == ["green", "off"]
    assert state["received"]["sound_sequence"]["number"] == 4


def test_what_the_driver_does_can_be_watched(emulate):
    base = emulate()
    with contextlib.closing(base.remote.watch()) as watch:
        events = iter(watch)
        with base.open() as port:
            assert next(events)["port"] == "opened"
            port.write(drive(100, 1) + STOP)
            first, second = next(events), next(events)
        assert next(events)["port"] == "closed"
    assert (first["command"], first["speed"], first["radius"]) == ("base_control", 100, 1)
    assert second["time"] >= first["time"] > 0.0


def test_a_last_word_is_heard_though_the_port_is_closed_at_once(emulate):
    base = emulate()
    with contextlib.closing(base.remote.watch()) as watch:
        with base.open() as port:
            port.write(STOP)
        assert any(event.get("command") == "base_control" for event in watch)


def test_an_unplugged_base_hangs_up_and_comes_back_elsewhere_driving_on(emulate):
    base = emulate("--dead-time", "0")
    with contextlib.closing(base.remote.watch()) as watch:
        with base.open() as port:
            port.write(drive(100))
            until(port, lambda told: told["core"]["left"] > 10)
            base.remote.tell("unplug 0.3")
            with pytest.raises(serial.SerialException):
                until(port, lambda _: False)
            assert not base.link.is_symlink()
        next(event for event in watch if event.get("port") == "closed")
        wait_until(base.link.is_symlink)
    with base.open() as port:
        assert packet(port)["core"]["left"] > 10
    assert base.remote.state()["speeds"]["left"] == pytest.approx(0.1)


def test_a_power_cycle_starts_the_time_again(emulate):
    base = emulate()
    with base.open() as port:
        until(port, lambda told: told["core"]["stamp"] >= 500)
        base.remote.tell("power_cycle 0.1")
        assert until(port, lambda told: told["core"]["stamp"] < 500)["core"]["stamp"] == 20


@pytest.mark.parametrize("fault", ["garbage 500", "cut 7", "corrupt 3", "pause 0.1", "skip 20.002"])
def test_after_a_fault_of_the_line_the_stream_goes_on(emulate, fault):
    base = emulate()
    with base.open() as port:
        assert packet(port)["core"]["bumper"] == 0
        base.remote.tell(fault)
        base.remote.tell("bumper left on")
        assert until(port, lambda told: told["core"]["bumper"])["core"]["bumper"] == 4


def test_old_firmware_speaks_the_old_way(emulate):
    with emulate("--firmware", "0.9.0").open() as port:
        port.read_until(b"\xaa\x55")
        assert port.read(2) == bytes([54, 1])


def test_a_driver_that_does_not_read_stops_nothing(emulate):
    base = emulate()
    with base.open() as port:
        base.remote.tell("garbage 100000")
        wait_packets(base, 20)
        until(port, lambda told: told["core"]["stamp"] > 500)


def test_a_bad_line_is_answered_with_what_was_expected(emulate):
    base = emulate()
    with pytest.raises(ControlError, match="expected bumper left"):
        base.remote.tell("bumper upwards on")
    with socket.socket(socket.AF_UNIX) as client:
        client.connect(str(base.control))
        client.sendall(b"x" * 5000)
        assert client.recv(1) == b""  # who sends no line end is sent away
    assert base.remote.tell("bumper left on") == "ok"


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT])
def test_a_signal_ends_it_with_0_and_nothing_is_left_behind(emulate, number):
    base = emulate()
    with base.open() as port:
        packet(port)
        base.process.signal(number)
        assert base.process.end() == 0
    assert not base.link.is_symlink()
    assert not base.control.exists()


def test_a_killed_base_may_be_followed_by_another(emulate):
    base = emulate()
    base.process.signal(signal.SIGKILL)
    base.process.expected = -signal.SIGKILL
    assert base.process.end() == -signal.SIGKILL
    assert base.link.is_symlink()
    with emulate().open() as port:
        assert packet(port)["core"]["battery"] == 164


def refused(*options):
    done = forked.ask("simulator.kobuki", *options, timeout=DEADLINE)
    assert (done.returncode, done.stdout, done.stderr.count("\n")) == (2, "", 1), done.stderr
    return done.stderr


def test_what_cannot_be_is_refused_with_one_line(tmp_path):
    file = tmp_path / "file"
    file.write_text("precious")
    link = tmp_path / "kobuki"
    assert "is there and is no link" in refused("--link", file)
    assert file.read_text() == "precious"
    assert "cannot link" in refused("--link", tmp_path / "nowhere" / "kobuki")
    assert "is no version" in refused("--link", link, "--firmware", "new")
    assert "noise of -1.0" in refused("--link", link, "--slip-noise", "-1")
    assert "cannot listen at" in refused("--link", link, "--control", file)
    assert not link.is_symlink()


def test_two_bases_do_not_share_a_control_socket(emulate, tmp_path):
    base = emulate()
    assert "cannot listen at" in refused("--link", tmp_path / "other", "--control", base.control)
    assert base.remote.state()["packets"] >= 0
