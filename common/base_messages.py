"""The messages of the robot's base, each field with its unit and limits."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from common.message import Float32s, ListAsTuple, Message, Stamp

Pair = Annotated[tuple[float, float], ListAsTuple]
Triple = Annotated[tuple[float, float, float], ListAsTuple]
Matrix3 = Annotated[list[float], Field(min_length=9, max_length=9)]  # row by row
Flags2 = Annotated[tuple[bool, bool], ListAsTuple]  # left, right
Flags3 = Annotated[tuple[bool, bool, bool], ListAsTuple]  # left, centre, right
Counts3 = Annotated[tuple[int, int, int], ListAsTuple]  # left, centre, right

Rule = Literal[
    "free",
    "no_base",
    "refused",
    "stopped",
    "wheel_drop",
    "overcurrent",
    "cliff",
    "bumper",
    "odometry",
    "no_command",
    "no_scan",
    "obstacle",
    "limit",
]


class Velocity(Message):
    """What somebody wants the robot to do."""

    stamp: Stamp
    linear: float  # [m/s] forward
    angular: float  # [rad/s] counter-clockwise
    source: str = ""  # who drives: one source at a time
    priority: Annotated[int, Field(ge=-(2**31), lt=2**31)] = 0  # a higher one takes over at once


class Odometry(Message):
    """Where the robot is by its wheels and its gyro, and how it moves; no jumps, but it drifts."""

    stamp: Stamp
    frame: str
    child_frame: str
    pose: Triple  # x, y [m], theta [rad]
    twist: Pair  # linear [m/s], angular [rad/s]
    pose_covariance: Matrix3  # of x, y, theta
    twist_covariance: Matrix3  # of the velocities along x and y and about z


class BaseState(Message):
    """What the base senses; left comes first, then centre, then right."""

    stamp: Stamp
    bumpers: Flags3  # pressed
    cliffs: Flags3  # no floor below the sensor
    cliff_counts: Counts3  # raw, 0 to 4095, not linear in the distance
    wheel_drops: Flags2  # hanging in the air
    overcurrents: Flags2  # above 3 A: the base cuts its motors
    currents: Pair  # [A] of the motors
    buttons: Flags3  # B0, B1, B2 pressed
    battery_voltage: float  # [V]
    battery_percent: float  # 0 to 100
    charger: str  # discharging, dock_charging, dock_charged, adapter_charging, adapter_charged, unknown
    dock_ir: Counts3  # bits 1 near left, 2 near centre, 4 near right, 8 far centre, 16 far left, 32 far right
    digital_inputs: Annotated[tuple[bool, bool, bool, bool], ListAsTuple]
    analog_inputs: Annotated[tuple[float, float, float, float], ListAsTuple]  # [V]


class Imu(Message):
    """The base's gyro: its own heading, and every sample since the packet before."""

    stamp: Stamp
    frame: str
    heading: float  # [rad] as the base integrates it, arbitrary zero
    heading_rate: float  # [rad/s]
    sample_stamps: list[Stamp]  # [ns], oldest first
    angular_velocities: Float32s  # [rad/s] about x, y, z, sample by sample


class SafetyState(Message):
    """Which rule holds, and what it did to the command."""

    stamp: Stamp
    rule: Rule
    distance: float  # [m] to what holds the robot back; -1 where nothing does
    asked: Pair  # linear [m/s], angular [rad/s]
    allowed: Pair  # linear [m/s], angular [rad/s]
    latched: bool  # until `clear_safety`
    note: str  # for people
