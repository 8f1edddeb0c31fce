"""What the base reports, as the messages that everybody reads."""

import numpy as np

from cliffscan.common.contract.base_messages import BaseState, Imu, Odometry
from cliffscan.services.kobuki.battery import FULL, full_voltage, percentage
from cliffscan.services.kobuki.contacts import BUTTONS, contacts
from cliffscan.services.kobuki.odometry import Estimate
from cliffscan.services.kobuki.protocol.packets import Feedback
from cliffscan.services.kobuki.protocol.sensors import (
    Charger,
    CliffCounts,
    Core,
    DockIr,
    DockSignal,
    GpInput,
    Gyro,
    Inertia,
    MotorCurrent,
)

ODOM, BASE, GYRO = "odom", "base_link", "gyro_link"
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
        felt, cliff, dock = contacts(core), self._cliff, self._dock
        return BaseState(
            stamp=stamp,
            bumpers=felt.bumpers,
            cliffs=felt.cliffs,
            cliff_counts=(cliff.left, cliff.centre, cliff.right),
            wheel_drops=felt.wheel_drops,
            overcurrents=felt.overcurrents,
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
