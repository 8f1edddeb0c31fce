"""What the base told, as the messages that everybody reads."""

from __future__ import annotations

import numpy as np

from cliffscan.common.contract.base_messages import BaseState, Imu, Odometry, SafetyState
from cliffscan.safety.gate import Decision
from cliffscan.services.kobuki.battery import FULL, full_voltage, percentage
from cliffscan.services.kobuki.odometry import Estimate
from cliffscan.services.kobuki.protocol.packets import Feedback
from cliffscan.services.kobuki.protocol.sensors import (
    Bumper,
    Button,
    Charger,
    Cliff,
    CliffCounts,
    Core,
    DockIr,
    DockSignal,
    GpInput,
    Gyro,
    Inertia,
    MotorCurrent,
    Overcurrent,
    WheelDrop,
)

ODOM, BASE, GYRO = "odom", "base_link", "gyro_link"


def _two(kind: type[WheelDrop] | type[Overcurrent]) -> tuple[tuple[bool, bool], ...]:
    """Left and right of all values that the flags can have."""
    return tuple((bool(flags & kind.LEFT), bool(flags & kind.RIGHT)) for flags in range(4))


def _three(*each: int) -> tuple[tuple[bool, bool, bool], ...]:
    """Three flags of all values that they can have."""
    left, centre, right = each
    return tuple((bool(flags & left), bool(flags & centre), bool(flags & right)) for flags in range(8))


# looked up, for an operation on flags takes ten times as long
BUMPERS = _three(Bumper.LEFT, Bumper.CENTRE, Bumper.RIGHT)
CLIFFS = _three(Cliff.LEFT, Cliff.CENTRE, Cliff.RIGHT)
BUTTONS = _three(Button.B0, Button.B1, Button.B2)
WHEEL_DROPS, OVERCURRENTS = _two(WheelDrop), _two(Overcurrent)
CHARGERS = {charger: charger.name.lower() for charger in Charger}


def odometry(estimate: Estimate, stamp: int) -> Odometry:
    """Where the robot is."""
    return Odometry(
        stamp=stamp,
        frame=ODOM,
        child_frame=BASE,
        pose=estimate.pose,
        twist=estimate.twist,
        pose_covariance=estimate.pose_covariance.rows(),
        twist_covariance=estimate.twist_covariance.rows(),
    )


class StateReport:
    """The state of the base; what a packet leaves out is as it was in the last one that had it."""

    def __init__(self) -> None:
        self._full = FULL
        self._cliff, self._current = CliffCounts(0, 0, 0), MotorCurrent(0.0, 0.0)
        self._dock = DockIr(DockSignal(0), DockSignal(0), DockSignal(0))
        self._inputs = GpInput((False, False, False, False), (0.0, 0.0, 0.0, 0.0))

    def update(self, feedback: Feedback, core: Core) -> None:
        """Take in a packet with a core."""
        self._full = full_voltage(core, self._full)
        self._cliff = feedback.cliff or self._cliff
        self._current = feedback.current or self._current
        self._dock = feedback.dock_ir or self._dock
        self._inputs = feedback.gp_input or self._inputs

    def message(self, core: Core, stamp: int) -> BaseState:
        """The state after the last packet, which had this core."""
        cliff, dock = self._cliff, self._dock
        return BaseState(
            stamp=stamp,
            bumpers=BUMPERS[core.bumper],
            cliffs=CLIFFS[core.cliff],
            cliff_counts=(cliff.left, cliff.centre, cliff.right),
            wheel_drops=WHEEL_DROPS[core.wheel_drop],
            overcurrents=OVERCURRENTS[core.overcurrent],
            currents=self._current,
            buttons=BUTTONS[core.buttons],
            battery_voltage=core.battery,
            battery_percent=percentage(core.battery, self._full),
            charger=CHARGERS[core.charger],
            dock_ir=(int(dock.left), int(dock.centre), int(dock.right)),
            digital_inputs=self._inputs.digital,
            analog_inputs=self._inputs.analog,
        )


def imu(gyro: Gyro, inertia: Inertia, stamp: int) -> Imu:
    """The gyro's samples of one packet."""
    return Imu(
        stamp=stamp,
        frame=GYRO,
        heading=inertia.angle,
        heading_rate=inertia.rate,
        sample_stamps=list(gyro.stamps(stamp)),
        angular_velocities=np.array(gyro.samples, np.float32).ravel(),
    )


def safety(decision: Decision, latched: bool, note: str, stamp: int) -> SafetyState:
    """Which rule holds."""
    return SafetyState(
        stamp=stamp,
        rule=decision.rule,
        distance=decision.distance,
        asked=decision.asked,
        allowed=decision.allowed,
        latched=latched,
        note=note,
    )
