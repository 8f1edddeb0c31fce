"""Whether a request is answered: no web page of others, and beyond this machine nobody without the token.

A browser carries any web page's requests to any address, and a name of an attacker's may point to this machine (DNS
rebinding). So a request must name this server by a number, as localhost or by this machine's own name, and a web page
that opens a socket must come from this very server. Programs that are no browser send no Origin.
"""

import hmac
import ipaddress
import secrets
import socket
from collections.abc import Collection
from typing import NamedTuple, Self

LOCALHOST = "localhost"


class Access(NamedTuple):
    """Decides whether a connection is accepted."""

    token: str  # that the address must carry; empty: none
    origins: Collection[str] = ()  # further web pages that may read, as https://app.example.org

    @classmethod
    def to(cls, bind: str, origins: Collection[str] = ()) -> Self:
        """The access to a server at an address: beyond this machine, with a token that nobody can guess."""
        return cls("" if is_loopback(bind) else secrets.token_urlsafe(16), origins)

    def stranger(self, host: str) -> str:
        """Why a request for this Host is not for this server, or nothing."""
        name = _name(host)
        if _is_number(name) or name.lower() in {LOCALHOST, *_own_names()}:
            return ""
        return f"the host {name!r} is not this machine: open the address that cliffscan view printed"

    def foreign_page(self, origin: str | None, host: str) -> str:
        """Why a web page may not open a socket here, or nothing; None is a program that is no browser."""
        if origin is None or origin == f"http://{host}" or origin in self.origins:
            return ""
        return f"the page {origin} is not this server's: --allow-origin {origin} lets it read"

    def without_token(self, token: str) -> str:
        """Why a request with this token, or with none, is refused, or nothing."""
        if not self.token or hmac.compare_digest(token.encode(), self.token.encode()):
            return ""
        return "the token is missing or wrong: open the whole address that cliffscan view printed, with its ?token="


def is_loopback(bind: str) -> bool:
    """Whether only this machine reaches a server at that address."""
    return bind == LOCALHOST or (_is_number(bind) and ipaddress.ip_address(bind).is_loopback)


def _name(host: str) -> str:
    """The Host header without its port and without the brackets of IPv6."""
    name = host.rsplit(":", 1)[0] if not host.endswith("]") and ":" in host else host
    return name.removeprefix("[").removesuffix("]")


def _is_number(name: str) -> bool:
    try:
        ipaddress.ip_address(name)
    except ValueError:
        return False
    return True


def _own_names() -> set[str]:
    own = socket.gethostname().lower()
    return {own, f"{own}.local"}
