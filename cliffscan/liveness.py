"""`cliffscan alive SERVICE`: whether a service works, for scripts and health checks."""

import sys
import time

from cliffscan.common.runtime.bus import Bus
from cliffscan.common.runtime.config import SERVICES
from cliffscan.common.runtime.service import StopSignal
from cliffscan.common.runtime.suggest import suggest
from cliffscan.live import NEWS, is_token
from cliffscan.plain import plain

TURN = 0.1  # [s] between two looks


def alive(service: str, bus: Bus, where: str, stop: StopSignal) -> int:
    """0 as soon as `service`, or one of several by that name, works; 1 where that takes longer than news can take."""
    deadline = time.monotonic() + NEWS
    while True:
        tokens = bus.alive()
        if any(is_token(service, token) for token in tokens):
            return 0
        if time.monotonic() > deadline or stop.wait(TURN):
            print(f"cliffscan: {plain(_complaint(service, tokens, bus.robot, where))}", file=sys.stderr)
            return 1


def _complaint(service: str, tokens: set[str], robot: str, where: str) -> str:
    if not tokens:
        return f"{service} is not alive, nor is any service of {robot}, {where}; is `cliffscan up` running?"
    there = ", ".join(sorted(tokens))
    return f"{service} is not alive; of {robot} there are {there}{suggest(service, {*tokens, *SERVICES} - {service})}"
