"""A certificate authority of one robot, and the certificates that it issues. Nothing is read or written here."""

import ipaddress
import re
from collections.abc import Sequence
from datetime import UTC, datetime, timedelta
from typing import NamedTuple

from cryptography import x509
from cryptography.hazmat.primitives import hashes
from cryptography.hazmat.primitives.asymmetric import ec
from cryptography.hazmat.primitives.asymmetric.types import CertificatePublicKeyTypes
from cryptography.x509.oid import ExtendedKeyUsageOID, NameOID

from cliffscan.common.runtime.secure import SecureError

CA_NAME = "cliffscan CA"
CA_LIFE = timedelta(days=3650)
EARLIER = timedelta(hours=1)  # a certificate holds for a clock that is a little behind
LONGEST_NAME = 64  # characters that a robot and a role may have in a certificate
HOST = re.compile(r"[A-Za-z0-9_.-]+")
THIS_MACHINE = ("localhost", "127.0.0.1", "::1")


class Authority(NamedTuple):
    """A CA: its certificate, and the key with which it signs."""

    certificate: x509.Certificate
    key: ec.EllipticCurvePrivateKey


def new_key() -> ec.EllipticCurvePrivateKey:
    """A private key."""
    return ec.generate_private_key(ec.SECP256R1())


def make_authority(robot: str) -> Authority:
    """A CA for a robot, which signs itself."""
    key, name = new_key(), _name(robot, CA_NAME)
    usage = x509.KeyUsage(
        digital_signature=False,
        content_commitment=False,
        key_encipherment=False,
        data_encipherment=False,
        key_agreement=False,
        key_cert_sign=True,
        crl_sign=True,
        encipher_only=False,
        decipher_only=False,
    )
    builder = (
        _builder(name, name, key.public_key(), CA_LIFE)
        .add_extension(x509.BasicConstraints(ca=True, path_length=0), critical=True)
        .add_extension(usage, critical=True)
    )
    return Authority(builder.sign(key, hashes.SHA256()), key)


def issue(
    authority: Authority,
    robot: str,
    role: str,
    public_key: CertificatePublicKeyTypes,
    life: timedelta,
    hosts: Sequence[str] | None = None,
) -> x509.Certificate:
    """A certificate for the holder of a key; one without `hosts` cannot stand in for a router.

    It ends with the authority's own at the latest, for nobody believes it any longer.
    hosts: of a router, the names and addresses by which it is reached beside those of THIS_MACHINE.
    """
    root = authority.certificate
    purposes = [ExtendedKeyUsageOID.CLIENT_AUTH, *([] if hosts is None else [ExtendedKeyUsageOID.SERVER_AUTH])]
    builder = (
        _builder(_name(robot, role), root.subject, public_key, min(life, root.not_valid_after_utc - datetime.now(UTC)))
        .add_extension(x509.BasicConstraints(ca=False, path_length=None), critical=True)
        .add_extension(x509.ExtendedKeyUsage(purposes), critical=False)
        .add_extension(x509.AuthorityKeyIdentifier.from_issuer_public_key(authority.key.public_key()), critical=False)
    )
    if hosts is not None:
        names = [host_name(each) for each in dict.fromkeys((*THIS_MACHINE, *hosts))]
        builder = builder.add_extension(x509.SubjectAlternativeName(names), critical=False)
    return builder.sign(authority.key, hashes.SHA256())


def _builder(
    subject: x509.Name, issuer: x509.Name, public_key: CertificatePublicKeyTypes, life: timedelta
) -> x509.CertificateBuilder:
    now = datetime.now(UTC)
    return (
        x509.CertificateBuilder()
        .subject_name(subject)
        .issuer_name(issuer)
        .public_key(public_key)
        .serial_number(x509.random_serial_number())
        .not_valid_before(now - EARLIER)
        .not_valid_after(now + life)
        .add_extension(x509.SubjectKeyIdentifier.from_public_key(public_key), critical=False)
    )


def _name(robot: str, role: str) -> x509.Name:
    return x509.Name(
        [x509.NameAttribute(NameOID.ORGANIZATION_NAME, robot), x509.NameAttribute(NameOID.COMMON_NAME, role)]
    )


def host_name(text: str) -> x509.GeneralName:
    """A host as a certificate names it. Raises SecureError."""
    try:
        return x509.IPAddress(ipaddress.ip_address(text))
    except ValueError:
        pass
    if not HOST.fullmatch(text):
        raise SecureError(
            f"--host {text}: is no host's name: letters, digits, - and ., without a port; xn--… for others"
        )
    return x509.DNSName(text)
