"""Prints the table of docs/security.md: what each role may, as the table of roles says it.

python -m cliffscan.secure.page
"""

from collections.abc import Iterable
from typing import Any

from cliffscan.common.contract.roles import NEIGHBOURS, ROLES, Role
from cliffscan.common.contract.topics import TOPICS, Topic

HEADER = "| role | of | publishes | receives | asks of the base | in ROS 2 |\n|---|---|---|---|---|---|"


def table() -> str:
    """All roles, the routers as each lets the other in."""
    routers = [NEIGHBOURS[name] for name in sorted(NEIGHBOURS)]
    return "\n".join([HEADER, *map(row, (*ROLES, *routers))])


def row(role: Role) -> str:
    """A role's line."""
    services = ", ".join(f"`{name.replace('$*', 'NAME')}`" for name in role.services if name != "*")
    own = f"status and token of {services or 'all'}" if role.services else ""
    published = ", ".join(filter(None, (paths(role.publishes), own)))
    received = "all" if set(role.receives) == set(TOPICS) else paths(role.receives)
    asked = ", ".join("anything" if name == "*" else f"`{name}`" for name in role.asks)
    cells = (f"`{role.name}`", role.what, *(each or "nothing" for each in (published, received, asked)), role.ros.value)
    return f"| {' | '.join(cells)} |"


def paths(topics: Iterable[Topic[Any]]) -> str:
    """The paths of rows."""
    return ", ".join(f"`{topic.path}`" for topic in topics)


if __name__ == "__main__":
    print(table())
