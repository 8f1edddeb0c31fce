"""The files of the page, which are beside this one, and the headers they travel with."""

from functools import cache
from http import HTTPStatus
from importlib.resources import files

from websockets.datastructures import Headers
from websockets.http11 import Response

TYPES = {
    ".html": "text/html; charset=utf-8",
    ".css": "text/css; charset=utf-8",
    ".js": "text/javascript; charset=utf-8",
    ".svg": "image/svg+xml",
}
INDEX = "index.html"
POLICY = "; ".join(  # nothing comes from elsewhere, and nobody puts the stop button into a page of his own
    (
        "default-src 'none'",
        "script-src 'self'",
        "style-src 'self'",
        "img-src 'self'",
        "connect-src 'self' ws://{host}",
        "base-uri 'none'",
        "form-action 'none'",
        "frame-ancestors 'none'",
    )
)


@cache
def page_files() -> dict[str, bytes]:
    """Every file of the page by its path; the index is at /."""
    folder = files("cliffscan.view") / "page"
    found = {f"/{each.name}": each.read_bytes() for each in folder.iterdir() if _ending(each.name) in TYPES}
    return found | {"/": found[f"/{INDEX}"]}


def page_response(path: str, host: str) -> Response:
    """The file at a path, for a browser that reaches this server as `host`."""
    body = page_files().get(path)
    if body is None:
        return plain_response(HTTPStatus.NOT_FOUND, f"there is no {path[:100]} here")
    return _response(HTTPStatus.OK, body, TYPES[_ending(path)] if path != "/" else TYPES[".html"], host)


def plain_response(status: HTTPStatus, text: str) -> Response:
    """A line for a person."""
    return _response(status, f"cliffscan view: {text}\n".encode(), "text/plain; charset=utf-8", "")


def _response(status: HTTPStatus, body: bytes, kind: str, host: str) -> Response:
    headers = Headers(
        {
            "Content-Type": kind,
            "Content-Length": str(len(body)),
            "Connection": "close",
            "Cache-Control": "no-cache",
            "Content-Security-Policy": POLICY.format(host=host),
            "Cross-Origin-Resource-Policy": "same-origin",
            "Referrer-Policy": "no-referrer",
            "X-Content-Type-Options": "nosniff",
        }
    )
    return Response(status.value, status.phrase, headers, body)


def _ending(name: str) -> str:
    return name[name.rfind(".") :] if "." in name else ""
