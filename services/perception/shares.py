"""Which of several processes serves which robot: each of them finds the same by itself, from the tokens that all see.

A process that serves every robot is a member of the fleet. It claims a robot before it serves it. A process that was
started for a robot by name claims it for as long as it runs, and goes before every member.
"""

from collections import Counter
from collections.abc import Collection, Iterable, Mapping
from hashlib import blake2b


def weight(robot: str, process: str) -> bytes:
    """How strongly a robot prefers a process (rendezvous hashing). It depends on no other process."""
    return blake2b(f"{robot} {process}".encode(), digest_size=8).digest()


def heaviest(robot: str, processes: Iterable[str]) -> str:
    """Which of these processes, one at least, goes before the others for a robot."""
    return max(processes, key=lambda process: (weight(robot, process), process))


def balanced(robots: Iterable[str], members: Collection[str], holders: Mapping[str, str]) -> dict[str, str]:
    """The member that serves each robot.

    holders: the member that serves a robot now. It keeps the robot unless it has two more than another member. A robot
    without one goes to a member that has the fewest. Among equals the weight decides.
    """
    if not members:
        return {}
    shares = {robot: member for robot, member in holders.items() if member in members}
    loads = Counter(dict.fromkeys(members, 0))
    loads.update(shares.values())

    def lightest(robot: str) -> str:
        least = min(loads.values())
        return heaviest(robot, (member for member in members if loads[member] == least))

    for robot in sorted(set(robots) - shares.keys()):
        shares[robot] = lightest(robot)
        loads[shares[robot]] += 1
    while max(loads.values()) - min(loads.values()) > 1:
        fullest = max(loads, key=lambda member: (loads[member], member))
        moved = max((robot for robot, member in shares.items() if member == fullest), key=lambda r: weight(r, fullest))
        target = lightest(moved)
        shares[moved] = target
        loads.update({fullest: -1, target: 1})
    return shares
