"""The Zenoh file of a role: whole, so that any Zenoh program opens it and has the rights of the role, no more."""

import json
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

from cliffscan.common.contract.roles import ROS_NODES, ROUTER, WORKSTATION_ROUTER, Role
from cliffscan.common.contract.ros_keys import DOMAIN
from cliffscan.common.runtime.access_rules import access_control
from cliffscan.common.runtime.secure import ROS_DOMAIN, ROUTERS, TLS, tls_settings
from cliffscan.common.runtime.zenoh_config import DEFAULTS
from cliffscan.parts import PORT

HERE = f"tls/127.0.0.1:{PORT}"  # each host's processes use the router on it


class MadeFor(NamedTuple):
    """What keys are made for: a robot, the hosts of routers, its own first, and its domain of ROS 2."""

    robot: str
    hosts: Sequence[str]
    ros_domain: int = DOMAIN


def zenoh_settings(folder: Path, role: str, made_for: MadeFor, roles: Iterable[Role]) -> dict[str, Any]:
    """The settings of a role whose files are in `folder`, as Zenoh nests them. roles: that routers admit."""
    settings: dict[str, object] = {
        **DEFAULTS,
        "scouting/multicast/enabled": False,
        **tls_settings(folder, role),
        f"{TLS}/enable_mtls": True,
        f"{TLS}/verify_name_on_connect": True,
        f"{TLS}/close_link_on_expiration": True,
        **_place(role, made_for.hosts),
        ROS_DOMAIN: made_for.ros_domain,
    }
    if role == ROS_NODES:
        settings["timestamping/enabled"] = True  # rmw_zenoh keeps no last samples without
    if role in ROUTERS:
        settings["access_control"] = access_control(made_for.robot, role, roles, made_for.ros_domain)
    return _nested(settings)


def text(settings: Mapping[str, Any], role: str, robot: str) -> str:
    """The file of these settings."""
    head = f"// {role} of robot {robot}, written by `cliffscan keys`. The key it names is secret; this file is not.\n"
    return head + json.dumps(settings, indent=2) + "\n"


def _place(role: str, hosts: Sequence[str]) -> dict[str, object]:
    """Where a role listens and connects."""
    if role == ROUTER:
        return {"mode": "router", "listen/endpoints": [f"tls/0.0.0.0:{PORT}"]}
    if role == WORKSTATION_ROUTER:
        robot = [f"tls/{_bracketed(host)}:{PORT}" for host in hosts[:1]]
        return {"mode": "router", "listen/endpoints": [HERE], "connect/endpoints": robot}
    return {"mode": "client", "connect/endpoints": [HERE]}


def _bracketed(host: str) -> str:
    """A host as an endpoint has it."""
    return f"[{host}]" if ":" in host else host


def _nested(settings: Mapping[str, object]) -> dict[str, Any]:
    """Settings by key, as `a/b`, as tables in tables."""
    nested: dict[str, Any] = {}
    for key, value in settings.items():
        *path, last = key.split("/")
        table = nested
        for part in path:
            table = table.setdefault(part, {})
        table[last] = value
    return nested
