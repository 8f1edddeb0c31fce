"""Base and camera at this machine: whether they are plugged in, and whether this user may use them.

The folders that Linux keeps of devices are arguments, so that tests have some of their own.
"""

import grp
import os
from collections.abc import Callable, Iterator
from pathlib import Path

from cliffscan.doctor.finding import Finding, fault, ok, warning

DEV, SYS = Path("/dev"), Path("/sys")
BASE, CAMERA = "base port", "camera"
RULE = "install udev/60-kobuki.rules (docs/robot.md), and plug the base in again"
KOBUKI_SERIAL = "kobuki"  # with which the serial number of its USB converter begins
KINECTS = {("045e", "02ae"), ("045e", "02bf")}  # vendor and product of a first Kinect's camera

Absent = Callable[[str, str], Finding]  # how bad it is that a device is not there


def check_port(port: Path, absent: Absent, sys: Path = SYS) -> Finding:
    """The serial port of a base."""
    if port.is_dir():
        return fault(BASE, f"{port}: is a folder, which Docker made where no base was: sudo rmdir {port}")
    if not port.exists():
        if unnamed := _unnamed_base(sys):
            return fault(BASE, f"{port}: is not there, but a Kobuki is at {unnamed}: {RULE}")
        return absent(BASE, f"{port}: is not there: plug the base in and switch it on, or set kobuki.port")
    if refused := _refused(port, "dialout"):
        return fault(BASE, refused)
    slow = _latency_timer(port, sys)
    if slow > 1:
        return warning(BASE, f"{port}: its converter hands over every {slow} ms, expected 1: {RULE}")
    return ok(BASE, f"{port}: can be read and written")


def check_kinect(absent: Absent, dev: Path = DEV, sys: Path = SYS) -> Finding:
    """The first Kinect that is plugged in."""
    for device in _usb_devices(sys):
        if (_text(device / "idVendor"), _text(device / "idProduct")) in KINECTS:
            bus, number = (int(_text(device / name) or 0) for name in ("busnum", "devnum"))
            node = dev / f"bus/usb/{bus:03}/{number:03}"
            refused = _refused(node, "plugdev")
            return fault(CAMERA, refused) if refused else ok(CAMERA, f"a Kinect, {node}: can be read and written")
    return absent(CAMERA, "no Kinect is plugged in: plug in its USB and its own power supply")


def _refused(node: Path, usual_group: str) -> str:
    """Why this user may not use a device, with the remedy; empty where it may."""
    if os.access(node, os.R_OK | os.W_OK):
        return ""
    try:
        found = node.stat()
        group = grp.getgrgid(found.st_gid)
    except (OSError, KeyError):
        return f"{node}: cannot be opened: is it passed into this container?"
    if not found.st_mode & 0o060:
        return f"{node}: only its owner may use it: install its udev rule, for the group {usual_group} (docs/robot.md)"
    user = os.environ.get("USER") or str(os.getuid())
    if user in group.gr_mem:
        return f"{node}: {user} joined {group.gr_name} after this login: log in again"
    return f"{node}: is for the group {group.gr_name}: sudo usermod -aG {group.gr_name} {user}, and log in again"


def _unnamed_base(sys: Path) -> str:
    """The port of a Kobuki that no udev rule has named; empty where there is none."""
    for tty in sorted(sys.glob("class/tty/ttyUSB*")):
        converter = (tty / "device").resolve().parents[1]
        if _text(converter / "serial").startswith(KOBUKI_SERIAL):
            return f"/dev/{tty.name}"
    return ""


def _latency_timer(port: Path, sys: Path) -> int:
    """After how long [ms] the converter of a port hands over what it received; 0 where it has no such setting."""
    return int(_text(sys / "class/tty" / port.resolve().name / "device/latency_timer") or 0)


def _usb_devices(sys: Path) -> Iterator[Path]:
    yield from sorted(sys.glob("bus/usb/devices/*"))


def _text(file: Path) -> str:
    """A file's text without the end of its line; empty where it cannot be read."""
    try:
        return file.read_text("utf-8", "replace").strip()
    except OSError:
        return ""
