"""The certificate that a process shows a secured router, looked at before it is shown.

A router refuses a wrong one without a word. So what can be known to be wrong here is said here, in one line with its
remedy. A role's folder holds FILES; the certificate's common name is the role, its organization the robot.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path

from cryptography import x509
from cryptography.exceptions import InvalidSignature
from cryptography.hazmat.primitives.serialization import Encoding, PublicFormat, load_pem_private_key
from cryptography.x509.oid import NameOID

from cliffscan.common.contract.roles import names
from cliffscan.common.runtime.secure import CA, CERTIFICATE, CONFIG, FILES, KEY, OWNER, ROOT, NotYetValid, SecureError

WHOLE = "copy ca/ from where it is whole, or make all keys anew by `cliffscan keys init`"
SOON = 30  # [days] before the end of a certificate in which a person is told


@dataclass(frozen=True)
class Identity:
    """The holder that a certificate names, and the certificate's end."""

    robot: str
    role: str
    begins: datetime
    ends: datetime

    @property
    def days(self) -> int:
        """Whole days that are left, negative after the end."""
        return (self.ends - datetime.now(UTC)).days


def read_certificate(file: Path) -> x509.Certificate:
    """The first certificate in a PEM file. Raises SecureError."""
    try:
        return x509.load_pem_x509_certificate(file.read_bytes())
    except OSError as error:
        raise SecureError(f"{file}: {error.strerror}; {_remedy(file)}") from error
    except ValueError as error:
        raise SecureError(f"{file}: is no certificate; {_remedy(file)}") from error


def identity_of(certificate: x509.Certificate) -> Identity:
    """Whose certificate it is, as far as it says so."""

    def named(what: x509.ObjectIdentifier) -> str:
        return "".join(str(each.value) for each in certificate.subject.get_attributes_for_oid(what))

    return Identity(
        named(NameOID.ORGANIZATION_NAME),
        named(NameOID.COMMON_NAME),
        certificate.not_valid_before_utc,
        certificate.not_valid_after_utc,
    )


def examine(folder: Path, role: str, robots: Sequence[str]) -> Identity:
    """Whom the folder of a role makes of a process that acts for `robots`. Raises SecureError where a router would not.

    A router that keeps other rules or another CA can only be noticed when it is asked.
    """
    if not _is_there(folder):
        if not _is_there(folder.parent):
            raise SecureError(f"{folder.parent}: is not there: is the name right? `cliffscan keys init` makes keys")
        raise SecureError(f"{folder}: is not there; {_remedy(folder / CERTIFICATE)}")
    for name in FILES:
        if not _is_there(folder / name):
            raise SecureError(f"{folder / name}: is not there; {_remedy(folder / name)}")
    certificate, root = read_certificate(folder / CERTIFICATE), read_certificate(folder / ROOT)
    identity = identity_of(certificate)
    _check_name(folder, identity, role, robots)
    _check_dates(folder, identity)
    _check_origin(folder, certificate, root)
    return identity


def _is_there(path: Path) -> bool:
    try:
        return path.exists()
    except OSError as error:  # another user's folder
        raise SecureError(f"{path}: {error.strerror}: {OWNER}") from error


def _check_name(folder: Path, identity: Identity, role: str, robots: Sequence[str]) -> None:
    file = folder / CERTIFICATE
    if identity.role != role:
        raise SecureError(f"{file}: is the certificate of {identity.role!r}, expected {role!r}; {_remedy(file)}")
    others = [robot for robot in robots if robot not in names(identity.robot)]
    if others:
        raise SecureError(
            f"{file}: is of robot {identity.robot!r}, expected {others[0]!r}:"
            f" give --robot {identity.robot} alone; each robot has keys and processes of its own"
        )


def _check_dates(folder: Path, identity: Identity) -> None:
    file, now = folder / CERTIFICATE, datetime.now(UTC)
    if now > identity.ends:
        raise SecureError(f"{file}: expired on {identity.ends:%Y-%m-%d}: `cliffscan keys renew {folder.parent}`")
    if now < identity.begins:
        raise NotYetValid(
            f"{file}: is not valid before {identity.begins:%Y-%m-%d %H:%M} UTC: set the clock of this machine (chrony)"
        )


def _check_origin(folder: Path, certificate: x509.Certificate, root: x509.Certificate) -> None:
    file = folder / CERTIFICATE
    try:
        certificate.verify_directly_issued_by(root)
    except (InvalidSignature, ValueError, TypeError) as error:
        raise SecureError(f"{file}: was issued by another CA than {ROOT} beside it; {_remedy(file)}") from error
    try:
        key = load_pem_private_key((folder / KEY).read_bytes(), None)
    except OSError as error:
        raise SecureError(f"{folder / KEY}: {error.strerror}: {OWNER}") from error
    except (ValueError, TypeError) as error:
        raise SecureError(f"{folder / KEY}: is no private key; {_remedy(folder / KEY)}") from error
    form = Encoding.DER, PublicFormat.SubjectPublicKeyInfo
    if key.public_key().public_bytes(*form) != certificate.public_key().public_bytes(*form):
        raise SecureError(f"{folder / KEY}: is not the key of {CERTIFICATE}; {_remedy(folder / KEY)}")


def _remedy(file: Path) -> str:
    """How a file of a role comes to be as it should."""
    folder, role = file.parents[1], file.parent.name
    if role == CA:
        return WHOLE
    if not (folder / CA).is_dir():
        return f"copy the folder {role} from where `cliffscan keys init` made it"
    if file.name == CONFIG:
        return f"`cliffscan keys renew {folder}` writes it"
    return f"`cliffscan keys issue {folder} {role}` makes it anew"
