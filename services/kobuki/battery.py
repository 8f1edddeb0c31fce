"""How full the Kobuki's battery is, from its voltage. Source: Kobuki driver."""

from cliffscan.services.kobuki.protocol.sensors import Core

FULL = 16.5  # [V], of a new battery
LOW = 14.0
DANGEROUS = 13.2
RESERVE = 5.0  # [%] left at the dangerous voltage


def full_voltage(core: Core, so_far: float = FULL) -> float:
    """The voltage [V] of this battery when full: what it has when the charger says so, else what it was so far.

    A battery that is low when it is charged has a fault, and teaches nothing.
    """
    return core.battery if core.charger.charged and core.battery > LOW else so_far


def percentage(voltage: float, full: float = FULL) -> float:
    """Charge [%], 0 to 100, of a battery at `voltage` [V] that has `full` [V] when charged."""
    charge = RESERVE + (100.0 - RESERVE) * (voltage - DANGEROUS) / (full - DANGEROUS)
    return min(max(charge, 0.0), 100.0)
