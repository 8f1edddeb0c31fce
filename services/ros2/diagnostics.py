"""How the services and the gate fare, as ROS diagnostics: a level, a text for people, and values."""

from cliffscan.common.contract.base_messages import SafetyState
from cliffscan.common.contract.messages import ServiceStatus
from cliffscan.services.ros2.messages import diagnostic_array

OK, WARN, ERROR = 0, 1, 2  # of a DiagnosticStatus
LEVELS = {"working": OK, "starting": WARN, "waiting": ERROR}
AT_WORK = ("free", "no_command", "limit", "obstacle")  # rules that hold while nothing is wrong


def of_status(status: ServiceStatus, robot: str) -> bytes:
    """A DiagnosticArray of a service's status; a note of one that works is a warning."""
    level = max(LEVELS[status.state], WARN if status.note else OK)
    median, worst = status.latency
    values = {
        "rate [Hz]": f"{status.rate:.1f}",
        "latency p50 [ms]": f"{1e3 * median:.1f}",
        "latency p99 [ms]": f"{1e3 * worst:.1f}",
        **{name: str(count) for name, count in status.counts.items()},
    }
    text = status.note or status.state
    return diagnostic_array(status.stamp, level, f"cliffscan: {status.service}", text, robot, values)


def of_safety(state: SafetyState, robot: str) -> bytes:
    """A DiagnosticArray of the gate: the rule that holds, and what it did to the command."""
    level = ERROR if state.latched else OK if state.rule in AT_WORK else WARN
    values = {
        "rule": state.rule,
        "distance [m]": f"{state.distance:.2f}",
        "asked [m/s, rad/s]": "{:.3f} {:.3f}".format(*state.asked),
        "allowed [m/s, rad/s]": "{:.3f} {:.3f}".format(*state.allowed),
    }
    return diagnostic_array(state.stamp, level, "cliffscan: gate", state.note or state.rule, robot, values)
