"""Why an endpoint cannot be reached. Zenoh only says that it cannot, whatever is the reason."""

import socket
import ssl
from collections.abc import Mapping
from pathlib import Path

from cliffscan.common.runtime import endpoints
from cliffscan.common.runtime.endpoints import Endpoint
from cliffscan.common.runtime.secure import CERTIFICATE, KEY, ROOT

PATIENCE = 1.0  # [s] for each step
OTHER_PROTOCOL = "WRONG_VERSION_NUMBER"  # OpenSSL's reason for an answer that is no TLS
ONE_CA = "make both with one `cliffscan keys init`, or copy the role's folder from there anew"
RENEW = "`cliffscan keys renew` where they were made, and copy cert.pem"

# Words in OpenSSL's reasons, in the order in which they are looked for, and what they mean with the remedy.
OURS: Mapping[str, str] = {  # the router is refused by the certificate that we trust
    "expired": f"its certificate has expired: {RENEW} to its folder",
    "not yet valid": "its certificate is not valid yet: set the clocks of both machines (chrony)",
    "purpose": "its certificate is no router's: start it with the folder of a router",
    "mismatch": "its certificate names other hosts: `cliffscan keys init` with --host, or connect by a name it has",
    "": f"its certificate is of another CA than ours: {ONE_CA}",
}
THEIRS: Mapping[str, str] = {  # we are refused by the router
    "unknown_ca": f"it knows another CA than that of our certificate: {ONE_CA}",
    "expired": f"our certificate has expired, by its clock: {RENEW} here",
    "required": "it asks for a certificate: add --secure DIR",
    "": f"it refuses our certificate: {ONE_CA}",
}


def why_unreachable(text: str, folder: Path | None) -> str:
    """Why nothing passes at an endpoint, with the remedy; empty where nothing is found.

    folder: of the role whose keys are shown, None for none.
    """
    endpoint = endpoints.parse(text)
    if endpoint.protocol not in ("tcp", "tls") or not endpoint.port:
        return ""
    connected = False
    try:
        with socket.create_connection((endpoint.host, endpoint.port), PATIENCE) as connection:
            connected = True
            why = _secured(connection, endpoint, folder) if endpoint.keyed else _plain(connection)
    except TimeoutError:
        why = "" if connected else "no answer: is that machine on, and the port open in its firewall?"
    except socket.gaierror as error:
        why = f"{error.strerror}: is the name right?"
    except UnicodeError:  # of the encoding of names
        why = "no host can have that name: is it right?"
    except OSError as error:
        why = "" if connected else f"{error.strerror}: is a router running there?"
    return f"{text}: {why}" if why else ""


def _secured(connection: socket.socket, endpoint: Endpoint, folder: Path | None) -> str:
    """What a TLS handshake finds, with the keys of a folder."""
    context = _context(folder)
    try:
        secured = context.wrap_socket(connection, server_hostname=endpoint.host, do_handshake_on_connect=False)
        secured.do_handshake()
    except ssl.SSLCertVerificationError as error:
        return _meaning(error.verify_message, OURS)
    except (TimeoutError, ssl.SSLError, ConnectionError) as error:
        return _refusal(error) or "it does not answer in TLS: start that router with --secure DIR"
    try:
        secured.recv(1)  # the router judges our certificate when we take the handshake for done, and then waits for us
    except TimeoutError:
        return ""
    except OSError as error:
        return _refusal(error) or "it hangs up"
    return ""


def _refusal(error: OSError) -> str:
    """What an alert of the router means; empty where it sent none."""
    reason = getattr(error, "reason", None) or ""
    return _meaning(reason, THEIRS) if "ALERT" in reason else ""


def _context(folder: Path | None) -> ssl.SSLContext:
    """TLS as Zenoh speaks it: with the role's keys, trusting its CA alone; without keys it trusts nobody and asks."""
    context = ssl.SSLContext(ssl.PROTOCOL_TLS_CLIENT)
    if folder:
        context.load_verify_locations(folder / ROOT)
        context.load_cert_chain(folder / CERTIFICATE, folder / KEY)
    else:
        context.check_hostname = False
        context.verify_mode = ssl.CERT_NONE
    return context


def _plain(connection: socket.socket) -> str:
    """What answers a greeting in TLS, to which a router that is reached in plain TCP says nothing."""
    try:
        with _context(None).wrap_socket(connection) as secured:
            secured.recv(1)
    except ssl.SSLError as error:
        if _refusal(error):
            return "it speaks TLS: add --secure DIR, and write tls/ instead of tcp/"
        if error.reason == OTHER_PROTOCOL:
            return "what answers there is no router: is the port right?"
    return ""


def _meaning(reason: str, meanings: Mapping[str, str]) -> str:
    """The first meaning whose word is in the reason."""
    return next(meaning for word, meaning in meanings.items() if word in reason.lower())
