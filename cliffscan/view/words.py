"""Why the robot does what it does, in words: a headline for each of the gate's rules, and what a person can do."""

from typing import Literal, NamedTuple

from cliffscan.common.contract.base_messages import BaseState, Rule, SafetyState
from cliffscan.dashboard import MEANING

Level = Literal["quiet", "slowed", "held", "alarm"]

REMEDY: dict[Rule, str] = {  # what lets the robot go on
    "free": "",
    "limit": "",
    "no_command": "It stands until a program or a person drives it.",
    "no_base": "Is the base switched on, and its cable plugged in?",
    "refused": "Update the base's firmware.",
    "stopped": "Look around, then clear it.",
    "wheel_drop": "Set it on the floor.",
    "overcurrent": "Free its wheels.",
    "cliff": "It backs off by itself.",
    "bumper": "It backs off by itself.",
    "odometry": "Look whether its wheels slip, then clear it.",
    "no_scan": "It goes on with the next fused scan: look at the services below.",
    "obstacle": "It may turn, and drive where the floor is free.",
}


class Headline(NamedTuple):
    """What a rule means for the robot, and how loudly the page says so."""

    text: str
    level: Level


HEADLINES: dict[Rule, Headline] = {
    "free": Headline("Free", "quiet"),
    "limit": Headline("Slowed down", "slowed"),
    "no_command": Headline("Nobody drives", "quiet"),
    "no_base": Headline("No base", "alarm"),
    "refused": Headline("Base refused", "alarm"),
    "stopped": Headline("Emergency stop", "alarm"),
    "wheel_drop": Headline("Wheel in the air", "alarm"),
    "overcurrent": Headline("Motor overloaded", "alarm"),
    "cliff": Headline("Cliff sensor", "held"),
    "bumper": Headline("Bumper", "held"),
    "odometry": Headline("Odometry not believed", "alarm"),
    "no_scan": Headline("No fresh scan", "held"),
    "obstacle": Headline("Stopped", "held"),
}


class Why(NamedTuple):
    """The rule that holds, for people."""

    headline: str
    level: Level
    reason: str
    remedy: str


def why(state: SafetyState) -> Why:
    """What holds the robot. What stands in its way and only slows it down is no reason for an alarm."""
    headline, level = HEADLINES[state.rule]
    reason = state.note or MEANING[state.rule]
    if state.rule == "obstacle":
        headline, level = ("Slowed down", "slowed") if state.allowed[0] else ("Stopped", "held")
        what = state.note.partition(",")[0]
        headline = f"{headline}: {what}" if what else headline
    if state.distance >= 0.0:
        reason = f"{reason}, {state.distance:.2f} m to go"
    if state.rule == "no_scan" and state.note:
        reason = f"{MEANING['no_scan']}: {state.note}"
    remedy = REMEDY[state.rule]
    if state.latched and state.rule not in ("stopped", "odometry"):
        remedy = f"{remedy} A stop is pressed as well: it holds until it is cleared.".strip()
    return Why(headline, level, reason, remedy)


def felt(state: BaseState) -> list[str]:
    """What the base's sensors report now, in words."""
    sides = ("left", "centre", "right")
    wheels = ("left", "right")
    return [
        *(f"cliff {side}" for side, fires in zip(sides, state.cliffs, strict=True) if fires),
        *(f"bumper {side}" for side, fires in zip(sides, state.bumpers, strict=True) if fires),
        *(f"{side} wheel in the air" for side, fires in zip(wheels, state.wheel_drops, strict=True) if fires),
        *(f"{side} motor overloaded" for side, fires in zip(wheels, state.overcurrents, strict=True) if fires),
    ]


def notice(connected: bool, found: bool, robot: str, others: list[str], where: str) -> str:
    """What keeps the page from showing the robot, with the remedy; empty where nothing does."""
    if not connected:
        return f"No router answers {where}. The page goes on when one does: is cliffscan up running?"
    if not found and others:
        return f"Nothing of {robot} is received. Other robots are there: choose one above."
    if not found:
        return f"No robot is found {where}. Start one with: cliffscan up"
    return ""
