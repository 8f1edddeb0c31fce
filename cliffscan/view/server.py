"""The page and its sockets on one port."""

import logging
import threading
from collections.abc import Sequence
from http import HTTPStatus
from typing import NamedTuple, Self
from urllib.parse import parse_qs, urlsplit

from websockets.http11 import Request, Response
from websockets.sync.server import ServerConnection, serve
from websockets.typing import Subprotocol

from cliffscan.common.contract.topics import ROBOT_NAME
from cliffscan.common.runtime.config import ConfigError
from cliffscan.view.access import Access
from cliffscan.view.foxglove import SUBPROTOCOLS, FoxgloveClient
from cliffscan.view.page_files import page_response, plain_response
from cliffscan.view.robots import Robots
from cliffscan.view.viewer import Viewer

PAGE_PROTOCOL = "cliffscan.view.v1"
LARGEST = 16_384  # [bytes] of what a viewer sends
HANDSHAKE = 3.0  # [s] a connection may take to say what it wants
NETWORK = 3.0  # [s] that a program waits for a router, which has no page that could tell
MOST_VIEWERS = 16
ENDING = 0.4  # [s]
PROTOCOL_ERROR, TRY_AGAIN = 1002, 1013  # close codes of RFC 6455

quiet = logging.getLogger(f"{__name__}.websockets")
quiet.setLevel(logging.CRITICAL)  # what strangers send to a port is no error of this program


class _Asked(NamedTuple):
    """What a request asks for, and for whom."""

    path: str
    query: str
    host: str
    origin: str | None
    opens: bool  # a socket
    doubtful: str  # why it is not clear, or nothing

    @classmethod
    def of(cls, request: Request) -> Self:
        """The question of a request."""
        hosts, origins = (request.headers.get_all(name) for name in ("Host", "Origin"))
        upgrades = (each.lower() for each in request.headers.get_all("Upgrade"))
        path, query = urlsplit(request.path)[2:4]
        doubtful = "" if len(hosts) == 1 and len(origins) <= 1 else "expected one Host and at most one Origin"
        return cls(path, query, "".join(hosts[:1]), next(iter(origins), None), "websocket" in upgrades, doubtful)


class Server:
    """A context manager: serves from entering to leaving. Raises ConfigError where the port cannot be had."""

    def __init__(self, bind: str, port: int, access: Access, robots: Robots) -> None:
        self._access = access
        self._robots = robots
        self._viewers = threading.Semaphore(MOST_VIEWERS)
        try:
            self._server = serve(
                self._handle,
                bind,
                port,
                process_request=self._answer,
                select_subprotocol=_chosen,
                compression=None,  # pictures are compressed, and the rest is small
                max_size=LARGEST,
                open_timeout=HANDSHAKE,
                server_header=None,
                logger=quiet,
            )
        except OSError as error:
            reason = error.strerror or str(error)
            raise ConfigError(f"--bind {bind} --port {port}: {reason}; another --port may be free") from error
        self.port: int = self._server.socket.getsockname()[1]

    def __enter__(self) -> Self:
        threading.Thread(target=self._server.serve_forever, name="view server", daemon=True).start()
        return self

    def __exit__(self, *_: object) -> None:
        closing = threading.Thread(target=self._server.shutdown, name="view shutdown", daemon=True)
        closing.start()
        closing.join(ENDING)

    def _answer(self, connection: ServerConnection, request: Request) -> Response | None:  # noqa: ARG002
        """The page's files, or a refusal; None for a socket that may be opened."""
        asked = _Asked.of(request)
        refusal = asked.doubtful or self._access.stranger(asked.host)
        if asked.opens:
            refusal = refusal or self._access.foreign_page(asked.origin, asked.host)
        if asked.opens or asked.path in ("/", "/index.html"):  # the other files are the same everywhere
            refusal = refusal or self._access.without_token(_value(asked.query, "token"))
        if refusal:
            return plain_response(HTTPStatus.FORBIDDEN, refusal)
        return None if asked.opens else page_response(asked.path, asked.host)

    def _handle(self, connection: ServerConnection) -> None:
        if not self._viewers.acquire(blocking=False):
            connection.close(TRY_AGAIN, f"{MOST_VIEWERS} viewers look already")
            return
        try:
            self._serve(connection)
        finally:
            self._viewers.release()

    def _serve(self, connection: ServerConnection) -> None:
        if connection.subprotocol == PAGE_PROTOCOL:
            Viewer(connection, self._robots).run()
        elif connection.subprotocol in SUBPROTOCOLS:
            query = urlsplit(connection.request.path).query if connection.request else ""
            robot = _value(query, "robot") or self._robots.preferred
            view = self._robots.view(robot, NETWORK) if ROBOT_NAME.fullmatch(robot) else None
            if view is None:
                connection.close(TRY_AGAIN, "no router answers yet, or that is no robot's name")
            else:
                FoxgloveClient(connection, view.feeds).run()
        else:
            connection.close(PROTOCOL_ERROR, f"expected the subprotocol {' or '.join(SUBPROTOCOLS)}")


def _chosen(_connection: ServerConnection, offered: Sequence[Subprotocol]) -> Subprotocol | None:
    """The first of the offered subprotocols that is spoken here."""
    return next((each for each in offered if each in (PAGE_PROTOCOL, *SUBPROTOCOLS)), None)


def _value(query: str, name: str) -> str:
    """A value of a query, empty where there is none."""
    return parse_qs(query).get(name, [""])[0]
