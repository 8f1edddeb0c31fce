"""Whether a process gets on to the network at all, and why not: a router refuses keys and messages without a word."""

import logging
import threading
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from importlib import import_module
from types import ModuleType
from typing import Self

from cliffscan.common.contract.roles import ROLES, Role, may_publish, may_receive, role_named
from cliffscan.common.contract.topics import alive
from cliffscan.common.runtime.secure import CERTIFICATE, CONFIG, ROS_DOMAIN, Credentials, SecureError
from cliffscan.common.runtime.tls_probe import why_unreachable
from cliffscan.common.runtime.zenoh_config import given_value, written_in

FIRST_LOOK, LOOK = 0.5, 2.0  # [s] after the start, and between two looks
ADMISSION = 3  # looks in which a router that admits us has shown itself
EXPIRY_LOOK = 60.0  # [s] between two looks at the certificate
EXTRA = "cliffscan[secure]"

log = logging.getLogger(__name__)


def _identity_module() -> ModuleType:
    """What looks at certificates, loaded only by who needs it. Raises SecureError where it cannot be."""
    try:
        return import_module("cliffscan.common.runtime.identity")
    except ImportError as error:
        raise SecureError(f"--secure cannot read certificates ({error}): install {EXTRA}") from error


@dataclass(frozen=True)
class Keys:
    """The keys of a process, which have been looked at."""

    credentials: Credentials
    robot: str

    @classmethod
    def of(cls, credentials: Credentials) -> Self:
        """Look at a role's keys. Raises SecureError."""
        return cls(
            credentials, _identity_module().examine(credentials.folder, credentials.role, credentials.robots).robot
        )

    @property
    def role(self) -> Role | None:
        """The row of the role; None for a router."""
        return role_named(self.credentials.role)

    @property
    def ros_domain(self) -> object:
        """The domain of ROS 2 for which the keys were made; None where they were made before there was one."""
        return given_value(written_in(self.credentials.folder / CONFIG), ROS_DOMAIN)

    def expiry(self) -> str:
        """That the certificate ends soon, or has ended; empty otherwise. Raises SecureError."""
        identity = _identity_module()
        file = self.credentials.folder / CERTIFICATE
        found = identity.identity_of(identity.read_certificate(file))
        if found.days >= identity.SOON:
            return ""
        when = f"expires in {found.days} days" if found.days >= 0 else "has expired"
        return f"its certificate {when} ({found.ends:%Y-%m-%d}): `cliffscan keys renew` where it was made"


def _names(may: Callable[[Role, str], bool], path: str) -> str:
    """The roles that may, in words."""
    return ", ".join(role.name for role in ROLES if may(role, path)) or "no role"


class Door:
    """Looks whether a session reaches others and is admitted, and logs what is wrong, once for each reason."""

    def __init__(self, endpoints: Sequence[str], keys: Keys | None, robot: str) -> None:
        """endpoints: to which the session connects."""
        self._endpoints = endpoints
        self._keys = keys
        self._robot = keys.robot if keys else robot
        self._closed = threading.Event()
        self._linked: Callable[[], bool] = lambda: False
        self._has_token: Callable[[str], bool] = lambda _: False
        self._notice, self._noticed_at = "", -EXPIRY_LOOK
        self._blocked = ""

    def open(self, linked: Callable[[], bool], has_token: Callable[[str], bool]) -> None:
        """The session is there. linked: whether it has a link; has_token: whether a token like this is known."""
        self._linked, self._has_token = linked, has_token

    def close(self) -> None:
        """End watch()."""
        self._closed.set()

    def watch(self) -> None:
        """Look now and then, until close()."""
        if not self._endpoints:
            return
        told, wait = "", FIRST_LOOK
        admitted, looks = not (self._keys and self._keys.role), 0
        while not self._closed.wait(wait):
            linked = self._linked()
            why = "" if linked else self.why_closed()
            if not (why or admitted or looks == ADMISSION):
                admitted, looks = self._has_token(f"{self._robot}/{alive('router-$*')}"), looks + 1
                why = "" if admitted or looks < ADMISSION else self._why_refused()
            wait = LOOK if admitted or looks == ADMISSION else FIRST_LOOK
            if why and why != told:
                log.warning("nothing passes: %s", why)
            told = why
            self._blocked = "" if linked and not why else why or f"{', '.join(self._endpoints)}: not connected yet"

    def why_closed(self) -> str:
        """Why no endpoint answers; empty where no reason is found."""
        folder = self._keys.credentials.folder if self._keys else None
        return "; ".join(filter(None, (why_unreachable(each, folder) for each in self._endpoints)))

    def _why_refused(self) -> str:
        """That the rules of the router have nothing for this process, though its certificate is a good one."""
        role = self._keys.credentials.role if self._keys else ""
        return (
            f"the router shows itself to no {role} of {self._robot}: it keeps older rules, or those of another robot:"
            " copy its folder from where `cliffscan keys` wrote it, and start it with `cliffscan router`"
        )

    def check_publishes(self, path: str) -> None:
        """Log that the router will not take what is published at a path."""
        role = self._keys.role if self._keys else None
        if role and not may_publish(role, path):
            others = _names(may_publish, path)
            log.warning("%s may not publish %s: a secured router drops it; %s may", role.name, path, others)

    def check_receives(self, path: str) -> None:
        """Log that the router will not pass on what is published at a path."""
        role = self._keys.role if self._keys else None
        if role and not may_receive(role, path):
            others = _names(may_receive, path)
            log.warning("%s may not receive %s: a secured router passes nothing of it; %s may", role.name, path, others)

    def check_ros_domain(self, domain: int) -> None:
        """Log that the router has no rules for a domain of ROS 2."""
        if self._keys and self._keys.ros_domain != domain:
            remedy = f"make keys by `cliffscan keys init --ros-domain {domain}`, or configure the domain of these"
            made_for = f"these keys are for {self._keys.ros_domain}"
            log.warning("ROS domain %d: a secured router passes nothing of it, %s: %s", domain, made_for, remedy)

    def notice(self) -> str:
        """What a person should know of the keys, and that nothing passes; empty where there is nothing."""
        blocked = self._blocked and f"nothing passes: {self._blocked}"
        return "; ".join(filter(None, (blocked, self._expiring())))

    def _expiring(self) -> str:
        """What is to be known of the keys; empty where there is nothing."""
        now = time.monotonic()
        if self._keys and now - self._noticed_at >= EXPIRY_LOOK:
            self._noticed_at = now
            try:
                notice = self._keys.expiry()
            except SecureError as error:
                notice = str(error)
            if notice and notice != self._notice:
                log.warning("%s", notice)
            self._notice = notice
        return self._notice
