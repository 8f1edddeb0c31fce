"""What the machine's own clock and TCP say."""

from cliffscan.doctor.finding import Level, fault, ok, warning, worst
from cliffscan.doctor.host import check_clock, check_congestion, clock_state


def test_a_clock_that_nothing_sets_is_told():
    assert clock_state() in range(-1, 6)
    assert check_clock(5).level is Level.WARNING
    assert [check_clock(state).level for state in (0, -1)] == [Level.OK] * 2
    assert check_clock(5, "robot").level is Level.WARNING
    assert check_clock(5, "workstation").level is Level.OK  # which may be the one that gives the time


def test_a_congestion_control_that_stalls_is_told_with_the_command(tmp_path):
    file = tmp_path / "tcp_congestion_control"
    assert check_congestion(file).level is Level.OK
    file.write_text("cubic\n")
    assert "tcp_congestion_control=bbr" in check_congestion(file).text
    file.write_text("bbr\n")
    assert check_congestion(file).level is Level.OK


def test_the_worst_finding_decides():
    assert worst([]) is Level.OK
    assert worst([ok("a", ""), warning("b", "")]) is Level.WARNING
    assert worst([fault("c", ""), ok("a", ""), warning("b", "")]) is Level.FAULT
