"""The machine that is looked from: whether its clock follows others, and how its TCP bears lost packets."""

import ctypes
from pathlib import Path

from cliffscan.doctor.finding import Finding, ok, warning
from cliffscan.parts import WORKSTATION

CLOCK, TCP = "this clock", "tcp"
TIMEX_BYTES = 256  # more than any struct timex; all zero it asks and sets nothing
TIME_ERROR = 5  # adjtimex(2): the clock is not synchronised
CONGESTION = Path("/proc/sys/net/ipv4/tcp_congestion_control")
BBR = "echo net.ipv4.tcp_congestion_control=bbr | sudo tee /etc/sysctl.d/60-bbr.conf && sudo sysctl --system"


def clock_state() -> int:
    """What adjtimex(2) returns: TIME_ERROR, less where the clock is synchronised, -1 where the kernel does not say."""
    return int(ctypes.CDLL(None).adjtimex(ctypes.create_string_buffer(TIMEX_BYTES)))


def check_clock(state: int, part: str | None = None) -> Finding:
    """Whether this machine's clock is synchronised. state: of clock_state()."""
    if state == TIME_ERROR and part == WORKSTATION:  # chrony's `local stratum` gives time, and tells the kernel nothing
        return ok(CLOCK, "follows no other: good where this host gives the robot its time (docs/deployment.md)")
    if state == TIME_ERROR:
        return warning(CLOCK, "is not synchronised: install chrony on both hosts (docs/deployment.md)")
    return ok(
        CLOCK, "is synchronised" if state >= 0 else "is the host's, which does not say whether it is synchronised"
    )


def check_congestion(file: Path = CONGESTION) -> Finding:
    """Whether TCP goes on sending where a radio link loses packets."""
    try:
        used = file.read_text("ascii").strip()
    except OSError:
        return ok(TCP, "the kernel does not say what controls its congestion")
    if used != "bbr":
        return warning(TCP, f"congestion control is {used}, which stalls where packets are lost: {BBR}")
    return ok(TCP, "congestion control is bbr")
