"""Zenoh's configuration: the project's own settings, below those of a file, below those of the command line.

What the settings are for: a large frame is dropped when one of its fragments waits too long for a full link, so
fragments may wait 0.2 s; the kernel's send buffer is kept small, or small real-time messages queue behind depth frames
in it; a link is given up after 2 s of silence; what no message may be as large as is not put together from its
fragments. Shared memory is off: where a process may not lock as much memory as its peers' pools take (8 MB is a usual
limit), Zenoh loses every large message without a word.

A router joins another one by two links, one of them for depth frames and other bulk: in a single link a command, a scan
or a pose would wait behind a frame that is being sent again. What goes between routers is compressed, without loss.
Zenoh agrees on both with the other end: a router that knows neither gets one plain link.
"""

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import zenoh

from cliffscan.common.contract.limits import LARGEST

Refused = zenoh.ZError  # what is raised for a file that is none
ENVELOPE = 65_536  # [bytes] that Zenoh adds to a payload, at most
DEFAULTS: dict[str, object] = {
    "transport/link/tx/lease": 2000,
    "transport/link/tx/queue/congestion_control/drop/wait_before_drop": 50_000,
    "transport/link/tx/queue/congestion_control/drop/max_wait_before_drop_fragments": 200_000,
    "transport/link/tcp/so_sndbuf": 65_536,
    "transport/link/tls/so_sndbuf": 65_536,
    "transport/link/rx/max_message_size": LARGEST + ENVELOPE,
    "transport/shared_memory/enabled": False,
}
BETWEEN_ROUTERS: dict[str, object] = {
    "transport/unicast/max_links": 2,
    "transport/unicast/compression/enabled": True,
}
LINKS = ("prio=0-5", "prio=6-7")  # Zenoh's priorities: DATA_LOW is 6
ENDPOINTS = ("connect/endpoints", "listen/endpoints")
LISTEN: dict[str, list[str]] = {  # by mode, where nobody says so: nothing beyond this machine can connect
    "router": ["tcp/127.0.0.1:7447"],
    "peer": ["tcp/127.0.0.1:0"],
}
THIS_MACHINE: dict[str, object] = {"scouting/multicast/interface": "lo"}  # where nobody names an endpoint


def build(options: Mapping[str, object], file: Path | None) -> zenoh.Config:
    """The configuration of `options` by key, over those of a JSON5 file, over the defaults. Raises zenoh.ZError."""
    config = zenoh.Config.from_file(str(file)) if file else zenoh.Config()
    given = written_in(file) if file else {}
    endpoints = any(key in options or given_value(given, key) for key in ENDPOINTS)
    router = (options.get("mode") or given_value(given, "mode")) == "router"
    defaults = (
        DEFAULTS | {"listen/endpoints": LISTEN} | (BETWEEN_ROUTERS if router else {} if endpoints else THIS_MACHINE)
    )
    for key, value in defaults.items():
        if given_value(given, key) is None:
            config.insert_json5(key, json.dumps(value))
    for key, value in options.items():
        each = _two_links(value) if router and key == ENDPOINTS[0] else value
        config.insert_json5(key, json.dumps(each))
    return config


def _two_links(endpoints: Any) -> list[str]:  # noqa: ANN401
    """Each of the endpoints once for either kind of messages; one that says what it is for stays as it is."""
    ways = (([end] if "?" in end else [_with(end, way) for way in LINKS]) for end in endpoints)
    return [link for links in ways for link in links]


def _with(endpoint: str, metadata: str) -> str:
    """An endpoint with metadata, which stands before its configuration: ADDRESS?METADATA#CONFIGURATION."""
    address, mark, configuration = endpoint.partition("#")
    return f"{address}?{metadata}{mark}{configuration}"


def endpoints_of(config: zenoh.Config, key: str) -> list[str]:
    """The endpoints that hold at a key of ENDPOINTS, in the mode that holds; each once, whatever links it has."""
    mode, endpoints = (json.loads(config.get_json(each)) for each in ("mode", key))
    if isinstance(endpoints, dict):
        endpoints = endpoints.get(mode or "peer")
    named = (each["endpoint"] if isinstance(each, dict) else each for each in endpoints or [])
    return list(dict.fromkeys(each.partition("?")[0] for each in named))


def asks_for_keys(config: zenoh.Config) -> bool:
    """Whether who connects by TLS must show a certificate of the right CA."""
    return json.loads(config.get_json("transport/link/tls/enable_mtls")) is True


def written_in(file: Path) -> dict[str, Any]:
    """What a JSON5 file says itself, which a Config no longer tells from Zenoh's defaults: Zenoh's own parser reads it.

    Raises zenoh.ZError.
    """
    parser = zenoh.Config()
    parser.insert_json5("metadata", file.read_text("utf-8"))  # takes any value
    given: dict[str, Any] = json.loads(parser.get_json("metadata"))
    return given


def given_value(given: dict[str, Any], key: str) -> object:
    """The value that a file gives a key; None where it gives none."""
    value: Any = given
    for part in key.split("/"):
        if not isinstance(value, dict):
            return None
        value = value.get(part)
    return value
