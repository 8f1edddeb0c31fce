"""A robot's keys on disk: `ca/` signs, and each role has a folder of its own to be carried to where it runs."""

import json
import os
from collections.abc import Iterator, Sequence
from datetime import timedelta
from pathlib import Path
from typing import Any

from cryptography.hazmat.primitives.asymmetric import ec
from cryptography.hazmat.primitives.serialization import (
    Encoding,
    NoEncryption,
    PrivateFormat,
    load_pem_private_key,
)

from cliffscan.common.contract.roles import ROLES, SENSOR, Role, is_sensor, role_names, sensor
from cliffscan.common.contract.ros_keys import DOMAIN
from cliffscan.common.runtime import zenoh_config
from cliffscan.common.runtime.identity import SOON, WHOLE, examine, identity_of, read_certificate
from cliffscan.common.runtime.secure import (
    CA,
    CERTIFICATE,
    CONFIG,
    KEY,
    OWNER,
    ROOT,
    ROS_DOMAIN,
    ROUTERS,
    TLS,
    SecureError,
    unreadable,
)
from cliffscan.common.runtime.suggest import suggest
from cliffscan.secure import role_file
from cliffscan.secure.authority import LONGEST_NAME, Authority, host_name, issue, make_authority, new_key
from cliffscan.secure.role_file import MadeFor

MADE_FOR = "made_for.json"
LIFE = timedelta(days=365)
SECRET, PUBLIC, PRIVATE_FOLDER = 0o600, 0o644, 0o700


class KeyFolder:
    """The keys of one robot. A file is replaced whole: who reads it at that moment reads the old or the new one."""

    def __init__(self, directory: Path) -> None:
        self.directory = directory.resolve()
        self._ca = self.directory / CA

    def init(self, robot: str, hosts: Sequence[str], life: timedelta = LIFE, ros_domain: int = DOMAIN) -> None:
        """Make the CA and the keys of all roles. Raises SecureError where there are some, before anything is made."""
        if len(robot) > LONGEST_NAME:
            raise SecureError(f"--robot {robot}: a certificate has room for {LONGEST_NAME} characters; name it shorter")
        if robot.partition("/")[0] == str(ros_domain):
            raise SecureError(f"--robot {robot}: its keys would be those of ROS domain {ros_domain}; name it otherwise")
        for host in hosts:
            host_name(host)
        authority = make_authority(robot)
        try:
            if self.directory.exists() and any(self.directory.iterdir()):
                raise SecureError(
                    f"{self.directory}: is not empty: name another folder, or `cliffscan keys issue` or `renew`"
                )
        except OSError as error:
            raise SecureError(f"{error.filename}: {error.strerror}; name another folder") from error
        for each in (self.directory, self._ca):
            _make_folder(each)
        _write(self._ca / KEY, _pem(authority.key), SECRET)
        _write(self._ca / CERTIFICATE, authority.certificate.public_bytes(Encoding.PEM), PUBLIC)
        made_for = MadeFor(robot, list(hosts), ros_domain)
        _write(self._ca / MADE_FOR, json.dumps(made_for._asdict()).encode(), PUBLIC)
        for role in role_names():
            self._issue(role, new_key(), life)

    def issue(self, role: str, life: timedelta = LIFE) -> bool:
        """Make a role's key, certificate and file anew. Whether the routers' rules changed. Raises SecureError."""
        if not is_sensor(role) and role not in role_names():
            names = role_names()
            meant = suggest(role, names)
            raise SecureError(
                f"{role!r} is no role: there are {', '.join(names)}, and {SENSOR}NAME for scan/NAME{meant}"
            )
        if len(role) > LONGEST_NAME:
            raise SecureError(f"{role}: a certificate has room for {LONGEST_NAME} characters; name it shorter")
        new_rules = is_sensor(role) and not (self.directory / role).exists()
        self._issue(role, new_key(), life)
        if new_rules:
            for router in ROUTERS:
                self._write_file(router)
        return new_rules

    def renew(self, life: timedelta = LIFE) -> list[str]:
        """New certificates for the keys that are there. The roles whose Zenoh file was rewritten. Raises SecureError.

        The file is left alone as long as it names this place and, a router's, keeps the present rules.
        """
        rewritten = []
        for role in self.roles():
            file = self.directory / role / KEY
            try:
                key = load_pem_private_key(file.read_bytes(), None)
            except (OSError, ValueError) as error:
                raise SecureError(f"{file}: {error}; `cliffscan keys issue {self.directory} {role}`") from error
            self._certify(role, key.public_key(), life)
            if self._fault_of_file(role):
                self._write_file(role)
                rewritten.append(role)
        return rewritten

    def check(self) -> Iterator[tuple[str, str, bool]]:
        """Each role, a line about it, and whether all is well with it. Raises SecureError where there are no keys."""
        for role in self.roles():
            folder = self.directory / role
            try:
                identity = examine(folder, role, [])
                self._check_authority(role)
                if fault := _open_to_others(folder / KEY) or self._fault_of_file(role):
                    raise SecureError(fault)
            except SecureError as error:
                yield role, str(error), False
                continue
            soon = identity.days < SOON
            remedy = f": `cliffscan keys renew {self.directory}`" if soon else ""
            yield role, f"valid until {identity.ends:%Y-%m-%d}, {identity.days} days{remedy}", not soon
        if (self._ca / KEY).exists() and (fault := _open_to_others(self._ca / KEY)):
            yield CA, fault, False
        if self._ca.is_dir() and (fault := _ends_soon(self._ca / CERTIFICATE)):
            yield CA, fault, False

    def roles(self) -> list[str]:
        """The roles whose folders are here. Raises SecureError where there are none."""
        found = [each.parent.name for each in sorted(self.directory.glob(f"*/{CONFIG}"))]
        if not found:
            raise SecureError(
                unreadable(self.directory)
                or f"{self.directory}: has no keys; `cliffscan keys init {self.directory}` makes some"
            )
        return found

    def _issue(self, role: str, key: ec.EllipticCurvePrivateKey, life: timedelta) -> None:
        authority = self._authority()
        folder = self.directory / role
        _make_folder(folder)
        _write(folder / KEY, _pem(key), SECRET)
        _write(folder / ROOT, authority.certificate.public_bytes(Encoding.PEM), PUBLIC)
        self._certify(role, key.public_key(), life)
        self._write_file(role)

    def _certify(self, role: str, public_key: Any, life: timedelta) -> None:  # noqa: ANN401 - of any kind
        made_for = self._made_for()
        hosts = made_for.hosts if role in ROUTERS else None
        certificate = issue(self._authority(), made_for.robot, role, public_key, life, hosts)
        _write(self.directory / role / CERTIFICATE, certificate.public_bytes(Encoding.PEM), PUBLIC)

    def _settings(self, role: str) -> dict[str, Any]:
        """What the Zenoh file of a role should be."""
        return role_file.zenoh_settings(self.directory / role, role, self._made_for(), self._table())

    def _write_file(self, role: str) -> None:
        words = role_file.text(self._settings(role), role, self._made_for().robot)
        _write(self.directory / role / CONFIG, words.encode(), PUBLIC)

    def _fault_of_file(self, role: str) -> str:
        """What is wrong with the Zenoh file of a role; empty where it can be used, or the CA is elsewhere."""
        if not self._ca.is_dir():
            return ""
        file, expected = self.directory / role / CONFIG, self._settings(role)
        try:
            written = zenoh_config.written_in(file)
        except (zenoh_config.Refused, ValueError):  # ValueError: it is no text
            return f"{file}: is no Zenoh file: `cliffscan keys renew {self.directory}` writes it anew"
        for key in [*(f"{TLS}/{name}" for name in expected["transport"]["link"]["tls"]), ROS_DOMAIN]:
            is_now, value = (zenoh_config.given_value(each, key) for each in (written, expected))
            if is_now != value:
                what = f"{key.rpartition('/')[2]} is {is_now!r}, expected {value!r}"
                return f"{file}: {what}: `cliffscan keys renew {self.directory}`"
        if written.get("access_control") != expected.get("access_control"):
            remedy = f"`cliffscan keys renew {self.directory}`, and copy it to the router"
            return f"{file}: keeps other rules than this version makes: {remedy}"
        return ""

    def _check_authority(self, role: str) -> None:
        """Raise SecureError where the CA here is not the role's."""
        root = self.directory / role / ROOT
        if self._ca.is_dir() and root.read_bytes() != (self._ca / CERTIFICATE).read_bytes():
            remedy = f"`cliffscan keys issue {self.directory} {role}`"
            raise SecureError(f"{root}: is another CA than {self._ca / CERTIFICATE}: {remedy}")

    def _table(self) -> list[Role]:
        """The roles that the routers admit: those of every robot, and the sensors of this one."""
        sensors = sorted(each.name for each in self.directory.glob(f"{SENSOR}*"))
        return [*ROLES, *(sensor(name.removeprefix(SENSOR)) for name in sensors)]

    def _made_for(self) -> MadeFor:
        file = self._ca / MADE_FOR
        data = self._read(file)
        try:
            return MadeFor(**json.loads(data))
        except (ValueError, TypeError) as error:
            raise SecureError(f"{file}: is not as `cliffscan keys init` made it: {WHOLE}") from error

    def _authority(self) -> Authority:
        file = self._ca / KEY
        data = self._read(file)
        try:
            key = load_pem_private_key(data, None)
        except (ValueError, TypeError) as error:
            raise SecureError(f"{file}: is no private key: {WHOLE}") from error
        if not isinstance(key, ec.EllipticCurvePrivateKey):
            raise SecureError(f"{file}: is no key that `cliffscan keys init` made: {WHOLE}")
        return Authority(read_certificate(self._ca / CERTIFICATE), key)

    def _read(self, file: Path) -> bytes:
        try:
            return file.read_bytes()
        except OSError as error:
            where = f"run this where `cliffscan keys init` made {CA}/, or make keys with it"
            raise SecureError(f"{file}: {error.strerror}: {where}") from error


def _open_to_others(file: Path) -> str:
    """That others may read a secret file; empty where they may not."""
    mode = file.stat().st_mode & 0o777
    return f"{file}: others may read it ({mode:o}): `chmod 600 {file}`" if mode & 0o077 else ""


def _ends_soon(authority: Path) -> str:
    """That a CA's certificate ends soon; empty where it does not. Raises SecureError."""
    found = identity_of(read_certificate(authority))
    remedy = "and all keys with it: make others by `cliffscan keys init`"
    return f"{authority}: ends on {found.ends:%Y-%m-%d}, {remedy}" if found.days < SOON else ""


def _make_folder(folder: Path) -> None:
    try:
        folder.mkdir(mode=PRIVATE_FOLDER, parents=True, exist_ok=True)
    except OSError as error:
        raise SecureError(f"{folder}: {error.strerror}; name another folder") from error


def _write(file: Path, data: bytes, mode: int) -> None:
    """Put a file in the place of one of that name, never readable by more than `mode` says."""
    beside = file.with_name(f".{file.name}.new")
    try:
        beside.unlink(missing_ok=True)
        with os.fdopen(os.open(beside, os.O_WRONLY | os.O_CREAT | os.O_EXCL, mode), "wb") as writing:
            writing.write(data)
        beside.replace(file)
    except OSError as error:
        remedy = f": {OWNER}" if isinstance(error, PermissionError) else ""
        raise SecureError(f"{file}: {error.strerror}{remedy}") from error


def _pem(key: ec.EllipticCurvePrivateKey) -> bytes:
    return key.private_bytes(Encoding.PEM, PrivateFormat.PKCS8, NoEncryption())
