"""Zenoh's access control, from the table of roles. All that no rule allows is refused, without a word to the sender.

A rule admits a key by inclusion: `scan/*` admits a subscription to `scan/fused`, not one to `**`. Zenoh also takes a
sample on `scan/*` for one on each key of it, so what is trusted is never granted by a wild card.
"""

from collections.abc import Iterable, Iterator, Sequence
from itertools import count
from typing import Any, NamedTuple

from cliffscan.common.contract.roles import NEIGHBOURS, Role, Ros, names
from cliffscan.common.contract.ros_keys import domain_keys, domain_tokens
from cliffscan.common.contract.topics import STATUS, Topic, alive, command

IN, OUT = "ingress", "egress"  # into the router, out of it


class Grant(NamedTuple):
    """What may pass: kinds of messages in one direction, on some paths below the robot's names, or some keys of ROS."""

    flow: str
    messages: tuple[str, ...]
    paths: tuple[str, ...]


# Everybody learns who subscribes and who is alive: publishers stay silent where nobody does.
EVERYBODY = (
    Grant(OUT, ("declare_subscriber", "declare_queryable"), ("**",)),
    Grant(IN, ("liveliness_query", "declare_liveliness_subscriber"), (alive("*"), alive("*/*"))),
    Grant(OUT, ("liveliness_token", "reply"), (alive("*"), alive("*/*"))),
)
ANY_ROBOT = f"**/{alive('*')}"  # the question which robots there are; the answer is about this one


def access_control(robot: str, router: str, roles: Iterable[Role], domain: int) -> dict[str, Any]:
    """Zenoh's setting `access_control` of a robot's router, with its domain of ROS 2.

    Its own role decides which other router it admits.
    """
    rules: list[dict[str, Any]] = []
    policies, subjects = [], []
    numbers = count(1)

    def rule(flow: str, messages: Sequence[str], keys: Sequence[str]) -> str:
        name = f"rule {next(numbers)}"
        allowed = {"messages": list(messages), "key_exprs": list(keys)}
        rules.append({"id": name, "permission": "allow", "flows": [flow], **allowed})
        return name

    def below(grants: Iterable[Grant]) -> list[str]:
        beginnings = names(robot)
        return [
            rule(each.flow, each.messages, [f"{name}/{path}" for name in beginnings for path in each.paths])
            for each in grants
        ]

    shared = [*below(EVERYBODY), rule(IN, ("liveliness_query",), [ANY_ROBOT])]
    for role in (*roles, NEIGHBOURS[router]):
        subjects.append({"id": role.name, "cert_common_names": [role.name]})
        in_ros = [rule(*grant) for grant in ros_grants(role.ros, domain)]
        policies.append({"rules": [*shared, *below(grants(role)), *in_ros], "subjects": [role.name]})
    return {
        "enabled": True,
        "default_permission": "deny",
        "rules": rules,
        "subjects": subjects,
        "policies": policies,
    }


def grants(role: Role) -> Iterator[Grant]:
    """What a role may do beside what EVERYBODY may."""
    kept = [each for each in role.publishes if each.latched]
    asked = [each for each in role.receives if each.latched]
    statuses = [STATUS.named(each).path for each in role.services]
    published, received = [*_paths(role.publishes), *statuses], _paths(role.receives)
    if published:
        yield Grant(IN, ("put",), tuple(published))
    if received:
        yield Grant(IN, ("declare_subscriber",), ("**",) if role.wild else received)
        yield Grant(OUT, ("put",), received)
    if role.services:
        of_processes = [f"{service}/*" for service in role.services]
        yield Grant(IN, ("liveliness_token",), tuple(map(alive, [*role.services, *of_processes])))
    if answered := (*_paths(kept), *map(command, role.answers)):
        yield Grant(IN, ("declare_queryable", "reply"), answered)
        yield Grant(OUT, ("query",), answered)
    if asks := (*_paths(asked), *map(command, role.asks)):
        yield Grant(IN, ("query",), asks)
        yield Grant(OUT, ("reply",), asks)


def ros_grants(ros: Ros, domain: int) -> Iterator[Grant]:
    """What a role may do in a domain of ROS 2: to receive takes tokens, and questions for what is kept."""
    if ros is Ros.NOTHING:
        return
    keys, graph = domain_keys(domain), (domain_tokens(domain), *domain_keys(domain))
    yield Grant(IN, ("declare_subscriber", "query"), keys)
    yield Grant(OUT, ("put", "declare_subscriber", "declare_queryable"), keys)
    yield Grant(IN, ("liveliness_token",), (domain_tokens(domain),))
    yield Grant(IN, ("liveliness_query", "declare_liveliness_subscriber"), graph)
    yield Grant(OUT, ("liveliness_token", "reply"), graph)
    if ros is Ros.ALL:
        yield Grant(IN, ("put", "declare_queryable", "reply"), keys)
        yield Grant(IN, ("liveliness_token",), keys)
        yield Grant(OUT, ("query",), keys)


def _paths(topics: Iterable[Topic[Any]]) -> tuple[str, ...]:
    """The paths of rows; of a family all of its keys."""
    return tuple(topic.path if topic.path == topic.prefix else f"{topic.prefix}/*" for topic in topics)
