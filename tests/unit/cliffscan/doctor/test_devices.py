"""Base and camera, in folders that look as Linux's."""

import os
import tempfile
from pathlib import Path

import pytest

from cliffscan.doctor.devices import check_kinect, check_port
from cliffscan.doctor.finding import Level, fault, warning

NOBODY = 65534


def converter(sys, tty, serial="kobuki_AI02", latency=1):
    """A USB serial converter, as in /sys; its tty."""
    device = sys / "devices/usb1/1-1/1-1:1.0" / tty
    (sys / "class/tty" / tty).mkdir(parents=True)
    device.mkdir(parents=True)
    (device.parents[1] / "serial").write_text(f"{serial}\n")
    (device / "latency_timer").write_text(f"{latency}\n")
    (sys / "class/tty" / tty / "device").symlink_to(device)


def test_a_port_that_can_be_used_is_fine(tmp_path):
    converter(tmp_path / "sys", "ttyUSB0")
    port = tmp_path / "ttyUSB0"
    port.touch()
    assert check_port(port, fault, tmp_path / "sys").level is Level.OK


def test_a_slow_converter_is_told_with_the_rule(tmp_path):
    converter(tmp_path / "sys", "ttyUSB0", latency=16)
    (tmp_path / "ttyUSB0").touch()
    named = tmp_path / "kobuki"
    named.symlink_to(tmp_path / "ttyUSB0")
    found = check_port(named, fault, tmp_path / "sys")
    assert found.level is Level.WARNING
    assert "every 16 ms, expected 1: install udev/60-kobuki.rules" in found.text


def test_a_base_without_its_rule_is_told_from_none(tmp_path):
    port, sys = tmp_path / "kobuki", tmp_path / "sys"
    assert check_port(port, warning, sys).level is Level.WARNING
    assert "plug the base in" in check_port(port, fault, sys).text
    converter(sys, "ttyUSB3", serial="FT232")
    assert "plug the base in" in check_port(port, fault, sys).text
    other = tmp_path / "other"
    converter(other, "ttyUSB7")
    found = check_port(port, warning, other)
    assert found.level is Level.FAULT
    assert "a Kobuki is at /dev/ttyUSB7: install udev/60-kobuki.rules" in found.text


def test_a_folder_in_the_place_of_the_port_is_told(tmp_path):
    (tmp_path / "kobuki").mkdir()
    assert "sudo rmdir" in check_port(tmp_path / "kobuki", fault, tmp_path).text


@pytest.fixture
def not_root():
    """Root may open every device, so it becomes somebody else for the while."""
    real, effective, saved = os.getresuid()
    if real == 0:
        os.setresuid(NOBODY, NOBODY, 0)
    yield
    os.setresuid(real, effective, saved)


def test_a_port_of_another_group_is_told_with_the_group(not_root):
    with tempfile.TemporaryDirectory() as folder:  # pytest's own is closed to others
        port = Path(folder) / "kobuki"
        port.touch(0o060)
        port.chmod(0o060)
        found = check_port(port, fault, Path(folder))
    assert found.level is Level.FAULT
    assert "is for the group" in found.text or "log in again" in found.text


def usb(sys, vendor="045e", product="02ae"):
    device = sys / "bus/usb/devices/1-2"
    device.mkdir(parents=True)
    values = {"idVendor": vendor, "idProduct": product, "busnum": "1", "devnum": "12"}
    for name, value in values.items():
        (device / name).write_text(f"{value}\n")


def test_a_kinect_that_can_be_opened_is_fine(tmp_path):
    usb(tmp_path / "sys")
    node = tmp_path / "dev/bus/usb/001/012"
    node.parent.mkdir(parents=True)
    node.touch()
    assert check_kinect(fault, tmp_path / "dev", tmp_path / "sys").level is Level.OK


def test_a_kinect_that_is_not_passed_on_is_told(tmp_path):
    usb(tmp_path / "sys")
    found = check_kinect(warning, tmp_path / "dev", tmp_path / "sys")
    assert found.level is Level.FAULT
    assert "is it passed into this container?" in found.text


def test_another_usb_device_is_no_kinect(tmp_path):
    usb(tmp_path / "sys", product="02b0")  # its motor
    assert check_kinect(warning, Path("/dev"), tmp_path / "sys").text.startswith("no Kinect is plugged in")
