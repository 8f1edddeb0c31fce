"""What can be known to be wrong before any process is started."""

import logging
import os
import socket
from collections.abc import Iterable, Sequence
from contextlib import suppress
from importlib import import_module
from pathlib import Path

from cliffscan.common.runtime import config as configuration
from cliffscan.common.runtime.config import ConfigError, ServiceConfig
from cliffscan.common.runtime.endpoints import parse
from cliffscan.common.runtime.network import BusError, Network, NotConnected, check

log = logging.getLogger("cliffscan")


def config_class(service: str) -> type[ServiceConfig]:
    """A service's configuration class. Raises ImportError where it cannot run here."""
    name = service.title().replace("_", "") + "Config"
    kind: type[ServiceConfig] = getattr(import_module(f"cliffscan.services.{service}.config"), name)
    return kind


def load_config(service: str, file: Path | None, overrides: Sequence[str]) -> ServiceConfig:
    """A service's configuration. Raises ConfigError where the service would refuse it, or cannot run here."""
    try:
        kind = config_class(service)
    except ImportError as error:
        raise ConfigError(f"{service} cannot run here: {error}; install cliffscan[all]") from error
    return configuration.load(service, kind, file, overrides)


def check_world(name: str) -> None:
    """Raise ConfigError where the simulator knows no world of that name, or is not there."""
    try:
        import_module("cliffscan.simulator.world").world_source(name)
    except (ImportError, ValueError) as error:
        raise ConfigError(str(error)) from error


def check_networks(networks: Iterable[Network]) -> None:
    """Raise ConfigError where a process could not be connected like this: for what it listens at, or for its keys.

    Keys that are not valid yet are waited for.
    """
    for network in networks:
        try:
            check(network)
        except NotConnected as error:
            log.warning("%s", error)
        except BusError as error:
            raise ConfigError(str(error)) from error


def check_free(endpoint: str) -> None:
    """Raise ConfigError where somebody listens at an endpoint already: what is started would join that router."""
    protocol, host, port = parse(endpoint)
    if protocol not in ("tcp", "tls") or not port:
        return  # the router says what is wrong
    with suppress(socket.gaierror, UnicodeError):  # no name, or what can be none
        for family, *_, where in socket.getaddrinfo(host, port, type=socket.SOCK_STREAM):
            try:
                socket.create_server(where[:2], family=family).close()
            except OSError as error:
                raise ConfigError(
                    f"{endpoint}: {os.strerror(error.errno or 0)}; does cliffscan run already?"
                ) from error
