"""What --secure DIR means: which folder, which files in it, and which of Zenoh's settings they fill."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from cliffscan.common.contract.roles import ROUTER, WORKSTATION_ROUTER
from cliffscan.common.runtime.endpoints import parse

ROOT, CERTIFICATE, KEY, CONFIG = "ca.pem", "cert.pem", "key.pem", "zenoh.json5"
FILES = (ROOT, CERTIFICATE, KEY, CONFIG)
CA = "ca"  # the folder of what signs; on no host but that where the keys are made
OWNER = "run this as the user whose keys they are"
ROUTERS = (ROUTER, WORKSTATION_ROUTER)
TLS = "transport/link/tls"
ROS_DOMAIN = "metadata/ros_domain"  # in a role's Zenoh file: the domain of ROS 2 for which the routers have rules


class SecureError(ValueError):
    """Keys that cannot be used; the text is one line that says why, with the remedy."""


class NotYetValid(SecureError):
    """Keys that can be used later, by the clock of this machine."""


def unreadable(folder: Path) -> str:
    """That a folder of keys, or one in it, is another user's; empty where it is not."""
    try:
        for each in (folder, *folder.iterdir()):
            (each / CERTIFICATE).exists()
    except PermissionError as error:
        return f"{error.filename}: {error.strerror}: {OWNER}"
    except OSError:  # it is not there, or is no folder
        pass
    return ""


@dataclass(frozen=True)
class Credentials:
    """The keys of a role, in a folder of `cliffscan keys`, and the robots for which they are meant to be used."""

    directory: Path
    role: str
    robots: Sequence[str] = ()

    @property
    def folder(self) -> Path:
        """The role's own folder."""
        return self.directory.resolve() / self.role


def tls_settings(folder: Path, role: str) -> dict[str, object]:
    """Zenoh's settings by key that name the files of a role's folder."""
    certificate, key = str(folder / CERTIFICATE), str(folder / KEY)
    settings: dict[str, object] = {
        f"{TLS}/root_ca_certificate": str(folder / ROOT),
        f"{TLS}/connect_certificate": certificate,
        f"{TLS}/connect_private_key": key,
    }
    if role in ROUTERS:
        settings |= {f"{TLS}/listen_certificate": certificate, f"{TLS}/listen_private_key": key}
    return settings


def check_listening(endpoints: Sequence[str], asks_for_keys: bool) -> None:
    """Raise SecureError where another machine could connect to one of these endpoints and show no keys."""
    for text in endpoints:
        endpoint = parse(text)
        if endpoint.beyond and not (endpoint.keyed and asks_for_keys):
            raise SecureError(
                f"--listen {text}: any machine that reaches it could drive the robot: add --secure DIR (`cliffscan keys"
                " init DIR` makes it), or --insecure"
            )


def check_secured(
    credentials: Credentials, mode: str | None, listen: Sequence[str], endpoints: Sequence[str], other_file: Path | None
) -> None:
    """Raise SecureError where the options of a process contradict its --secure.

    mode, listen: what its command line gives. endpoints: all that it will listen at or connect to.
    """
    role = credentials.role
    if other_file:
        raise SecureError(f"--zenoh-config {other_file}: --secure has a file of its own: leave one of them out")
    if role not in ROUTERS and (listen or mode not in (None, "client")):
        given = f"--listen {listen[0]}" if listen else f"--mode {mode}"
        raise SecureError(
            f"{given}: with --secure {role} is a client of a router, which checks what it does: leave it out"
        )
    for text in endpoints:
        if not parse(text).keyed:
            raise SecureError(f"{text}: is not encrypted; with --secure write tls/ instead of {parse(text).protocol}/")
