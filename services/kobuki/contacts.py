"""What the Kobuki feels, as the gate and the messages have it: flags to a bool for each side, left first."""

from cliffscan.safety.inputs import Contacts
from cliffscan.services.kobuki.protocol.sensors import Bumper, Button, Cliff, Core, Overcurrent, WheelDrop


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


def contacts(core: Core) -> Contacts:
    """What a packet's core says of the base's touch; button B0 is the emergency stop."""
    return Contacts(
        cliffs=CLIFFS[core.cliff],
        bumpers=BUMPERS[core.bumper],
        wheel_drops=WHEEL_DROPS[core.wheel_drop],
        overcurrents=OVERCURRENTS[core.overcurrent],
        stop_button=BUTTONS[core.buttons][0],
    )
