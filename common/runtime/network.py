"""Where the other processes are, and a Zenoh session that is open to them."""

from dataclasses import dataclass, field
from pathlib import Path

import zenoh

from cliffscan.common.runtime import zenoh_config
from cliffscan.common.runtime.door import Door, Keys
from cliffscan.common.runtime.endpoints import LAST_PORT
from cliffscan.common.runtime.endpoints import parse as endpoint_of
from cliffscan.common.runtime.secure import (
    CONFIG,
    Credentials,
    NotYetValid,
    SecureError,
    check_listening,
    check_secured,
    tls_settings,
)

TOKEN_TIMEOUT = 1.0  # [s] for a liveliness token to come


class BusError(Exception):
    """The network cannot be used as asked; the text is one line that says why."""


class NotConnected(BusError):
    """No endpoint answers yet; it is worth trying again."""


@dataclass(frozen=True)
class Network:
    """Where the other processes are. Endpoints as `tcp/127.0.0.1:7447`; with none, peers on this machine are found."""

    mode: str | None = None  # peer (Zenoh's default), client or router
    connect: list[str] = field(default_factory=list)
    listen: list[str] = field(default_factory=list)
    zenoh_config: Path | None = None
    secure: Credentials | None = None  # the file of its role takes the place of zenoh_config
    insecure: bool = False  # others may connect from beyond this machine without keys

    @property
    def file(self) -> Path | None:
        """The Zenoh file that holds."""
        return self.secure.folder / CONFIG if self.secure else self.zenoh_config

    def settings(self) -> dict[str, object]:
        """Zenoh's settings by key, where this says something."""
        named: dict[str, object] = {
            "mode": self.mode,
            "connect/endpoints": self.connect,
            "listen/endpoints": self.listen,
        }
        if self.mode != "router" and (self.connect or self.listen):  # a router answers whoever looks for one
            named["scouting/multicast/enabled"] = False  # others are where they were told to be
        keys = tls_settings(self.secure.folder, self.secure.role) if self.secure else {}
        return keys | {key: value for key, value in named.items() if value not in (None, [])}


def check(network: Network) -> None:
    """Raise BusError where the network cannot be used as asked, whoever is on it."""
    _configured(network)


def targets(network: Network) -> list[str]:
    """The endpoints to which a process connects. Raises BusError as check() does."""
    return zenoh_config.endpoints_of(_configured(network)[0], "connect/endpoints")


def _configured(network: Network) -> tuple[zenoh.Config, Keys | None]:
    """Zenoh's configuration, and the keys where there are some. Raises BusError."""
    try:
        if shapeless := [each for each in (*network.connect, *network.listen) if "/" not in each]:
            raise BusError(f"{shapeless[0]}: names no protocol: write it as tcp/HOST:PORT")
        keys = Keys.of(network.secure) if network.secure else None
        config = zenoh_config.build(network.settings(), network.file)
        _check_endpoints(network, config)
    except NotYetValid as error:
        raise NotConnected(str(error)) from error
    except SecureError as error:
        raise BusError(str(error)) from error
    except zenoh.ZError as error:
        raise BusError(f"Zenoh refuses the configuration: {first_line(error)}") from error
    return config, keys


def open_session(network: Network, robot: str) -> tuple[zenoh.Session, Door]:
    """A session, and the door through which it passes. Raises NotConnected, BusError."""
    config, keys = _configured(network)
    targets = zenoh_config.endpoints_of(config, "connect/endpoints")
    door = Door(targets, keys, robot)
    try:
        session = zenoh.open(config)
    except zenoh.ZError as error:
        reason = first_line(error)
        if "Unable to connect" in reason:
            raise NotConnected(door.why_closed() or reason) from error
        raise BusError(reason) from error
    door.open(lambda: linked(session), lambda pattern: _has_token(session, pattern))
    return session, door


def _check_endpoints(network: Network, config: zenoh.Config) -> None:
    """Raise SecureError where others could connect without keys, or a secured process speaks in the clear.

    BusError where an endpoint to connect to names no host or port, or one a port that there cannot be.
    """
    listens = zenoh_config.endpoints_of(config, "listen/endpoints")
    connects = zenoh_config.endpoints_of(config, "connect/endpoints")
    if nameless := [each for each in connects if endpoint_of(each).nameless]:
        raise BusError(f"--connect {nameless[0]}: names no host: write it as tcp/HOST:7447")
    if portless := [each for each in connects if endpoint_of(each).portless]:
        raise BusError(f"--connect {portless[0]}: names no port: write it as tcp/HOST:7447")
    if unreal := [each for each in (*connects, *listens) if endpoint_of(each).port > LAST_PORT]:
        raise BusError(f"{unreal[0]}: there is no such port: they end at {LAST_PORT}")
    if network.secure:
        check_secured(network.secure, network.mode, network.listen, [*listens, *connects], network.zenoh_config)
    elif not network.insecure:
        check_listening(listens, zenoh_config.asks_for_keys(config))


def linked(session: zenoh.Session) -> bool:
    """Whether there is a process at the other end of some link."""
    return bool(session.info.routers_zid() or session.info.peers_zid())


def linked_twice(session: zenoh.Session) -> bool:
    """Whether there is a process at the other end of two links, as between two of our routers."""
    ends = [str(link.zid) for link in session.info.links()]
    return len(set(ends)) < len(ends)


def _has_token(session: zenoh.Session, pattern: str) -> bool:
    return any(reply.ok for reply in session.liveliness().get(pattern, timeout=TOKEN_TIMEOUT))


def first_line(error: Exception) -> str:
    """Zenoh's reason without the place in its source."""
    return str(error).split(" at /")[0].splitlines()[0].strip()
