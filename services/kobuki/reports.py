"""What the base told, as the messages that everybody reads."""

from __future__ import annotations

import numpy as np

from common.base_messages import BaseState, Imu, Odometry, SafetyState
from services.kobuki.battery import FULL, full_voltage, percentage
from services.kobuki.odometry import Estimate
from services.kobuki.packets import Feedback
from services.kobuki.safety import Decision
from services.kobuki.sensors import Bumper, Button, Charger, Cliff, Core, Overcurrent, WheelDrop

ODOM, BASE, GYRO = "odom", "base_link", "gyro_link"


def odometry(estimate: Estimate, stamp: int) -> Odometry:
    """Where the robot is."""
    return Odometry(
        stamp=stamp,
        frame=ODOM,
        child_frame=BASE,
        pose=estimate.pose,
        twist=estimate.twist,
        pose_covariance=estimate.pose_covariance.ravel().tolist(),
        twist_covariance=estimate.twist_covariance.ravel().tolist(),
    )


class StateReport:
    """The state of the base; what a packet leaves out is as it was in the last one that had it."""

    def __init__(self) -> None:
        self._full = FULL
        self._last = Feedback()

    def update(self, feedback: Feedback, core: Core, stamp: int) -> BaseState:
        """The state after a packet with a core."""
        news = {name: value for name, value in feedback._asdict().items() if value is not None}
        self._last = last = self._last._replace(**news)
        self._full = full_voltage(core, self._full)
        cliff, dock, inputs = last.cliff, last.dock_ir, last.gp_input
        return BaseState(
            stamp=stamp,
            bumpers=(_has(core.bumper, Bumper.LEFT), _has(core.bumper, Bumper.CENTRE), _has(core.bumper, Bumper.RIGHT)),
            cliffs=(_has(core.cliff, Cliff.LEFT), _has(core.cliff, Cliff.CENTRE), _has(core.cliff, Cliff.RIGHT)),
            cliff_counts=(cliff.left, cliff.centre, cliff.right) if cliff else (0, 0, 0),
            wheel_drops=(_has(core.wheel_drop, WheelDrop.LEFT), _has(core.wheel_drop, WheelDrop.RIGHT)),
            overcurrents=(_has(core.overcurrent, Overcurrent.LEFT), _has(core.overcurrent, Overcurrent.RIGHT)),
            currents=(last.current.left, last.current.right) if last.current else (0.0, 0.0),
            buttons=(_has(core.buttons, Button.B0), _has(core.buttons, Button.B1), _has(core.buttons, Button.B2)),
            battery_voltage=core.battery,
            battery_percent=percentage(core.battery, self._full),
            charger=Charger(core.charger).name.lower(),
            dock_ir=(int(dock.left), int(dock.centre), int(dock.right)) if dock else (0, 0, 0),
            digital_inputs=inputs.digital if inputs else (False, False, False, False),
            analog_inputs=inputs.analog if inputs else (0.0, 0.0, 0.0, 0.0),
        )


def imu(feedback: Feedback, stamp: int) -> Imu | None:
    """The gyro's samples of one packet; None where it has none."""
    if feedback.gyro is None or feedback.inertia is None:
        return None
    return Imu(
        stamp=stamp,
        frame=GYRO,
        heading=feedback.inertia.angle,
        heading_rate=feedback.inertia.rate,
        sample_stamps=list(feedback.gyro.stamps(stamp)),
        angular_velocities=np.array(feedback.gyro.samples, np.float32).ravel(),
    )


def safety(decision: Decision, latched: bool, stamp: int) -> SafetyState:
    """Which rule holds."""
    return SafetyState(
        stamp=stamp,
        rule=decision.rule,
        distance=decision.distance,
        asked=decision.asked,
        allowed=decision.allowed,
        latched=latched,
        note=decision.note,
    )


def _has(flags: int, flag: int) -> bool:
    return bool(flags & flag)
