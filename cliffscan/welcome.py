"""What `cliffscan up` prints first: what it starts, and what to type next."""

from cliffscan.parts import GATE, NO_BASE, WORKSTATION, listening
from cliffscan.system import Plan

ANY, HERE = "0.0.0.0", "THIS_HOST"  # noqa: S104 - at which a router listens, and what others write for it


def welcome(plan: Plan) -> str:
    """Some lines for a person at an 80-column terminal."""
    options = _options(plan)
    lines = [
        f"cliffscan up: {_started(plan)}",
        "In another terminal:",
        f"  cliffscan status{options}    which services work, how fast, how late",
        f"  cliffscan list{options}      all live keys",
        f"  cliffscan view{options}      a page in the browser",
    ]
    if plan.base_service:
        lines.append(f"  cliffscan drive{options}     with the keyboard")
    if plan.world:
        lines.append("Another world: cliffscan up --world NAME (cliffscan up --help has the names)")
        lines.append("A real robot:  cliffscan up --base real --set capture.source=kinect")
    lines.append("Ctrl-C ends everything.")
    return "\n".join(lines)


def _started(plan: Plan) -> str:
    if plan.part == WORKSTATION:
        return f"{', '.join(plan.services)}, for the robot at {', '.join(plan.join) or 'the host that its keys name'}"
    here = _robot(plan)
    return f"{here}; the workstation connects to {plan.listen[0].replace(ANY, HERE)}" if plan.part else here


def _robot(plan: Plan) -> str:
    if plan.world:
        return f"a simulated TurtleBot 2 in the world {plan.world}"
    camera = f"the camera {plan.camera().source}"
    if plan.base == GATE:
        return f"the gate for a base that publishes base/odom and obeys base/cmd_vel_safe, and {camera}"
    return f"{camera}, without a base" if plan.base == NO_BASE else f"a real base and {camera}"


def _options(plan: Plan) -> str:
    """What the other commands need to find this robot."""
    robot = f" --robot {plan.robot}" if plan.robot != Plan.robot else ""
    usual = listening(None, bool(plan.secure))
    where = f" --connect {plan.endpoint}" if plan.endpoint != usual else ""
    keys = f" --secure {plan.secure}" if plan.secure else ""
    return robot + where + keys
