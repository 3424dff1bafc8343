"""The web server: viser's, with a guard around its hand-shake.

viser accepts WebSockets from any web origin and hands anybody a public share URL on request. Here every request must
name this machine in `Host`, every WebSocket must come from a page of this very server, share URLs are off, and any
address other than the loopback one asks for a token.
"""

from __future__ import annotations

import hmac
import http
import ipaddress
import secrets
import socket
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any
from urllib.parse import parse_qs, urlsplit

import rich
import viser
import websockets.asyncio.server
from viser import _messages
from websockets.asyncio.server import ServerConnection
from websockets.datastructures import Headers
from websockets.http11 import Request, Response

from grasp_core.errors import GraspError

_patching = threading.Lock()
_COOKIE = "grasp_workbench"


def is_loopback(host: str) -> bool:
    """Whether a host name or address reaches this machine only."""
    if host == "localhost":
        return True
    try:
        return ipaddress.ip_address(host.strip("[]")).is_loopback
    except ValueError:
        return False


class Guard:
    """Decides which HTTP requests and WebSocket hand-shakes may pass.

    Attributes:
        host: the address that the server is bound to.
        token: what requests must show (`?token=` once, a cookie afterwards); None on the loopback address.
    """

    def __init__(self, host: str, token: str | None) -> None:
        self.host = host
        self.token = token

    def refusal(self, headers: Headers, path: str, port: int) -> tuple[http.HTTPStatus, str] | None:
        """Why this request may not pass, or None.

        Args:
            headers: of the request.
            path: with the query.
            port: that the request came in on.
        """
        host = _authority(headers.get_all("Host"))
        if host is None or host[1] not in (port, None if port != 80 else 80) or not self._is_ours(host[0]):
            return http.HTTPStatus.FORBIDDEN, "403: this server answers only to its own address"
        if (headers.get("Upgrade") or "").lower() == "websocket":
            origins = headers.get_all("Origin")
            parts = urlsplit(origins[0]) if len(origins) == 1 else None
            if parts is None or parts.scheme not in ("http", "https") or _authority([parts.netloc]) != host:
                return http.HTTPStatus.FORBIDDEN, "403: WebSockets are accepted from this server's own page only"
        if self.token is not None and not self._shows_token(headers, path):
            return http.HTTPStatus.UNAUTHORIZED, "401: open the address with the token that grasp-workbench printed"
        return None

    def _is_ours(self, name: str) -> bool:
        if is_loopback(self.host):
            return is_loopback(name)
        # With a token the name only has to be an address or this machine's name, which a hostile page cannot rebind.
        try:
            ipaddress.ip_address(name.strip("[]"))
        except ValueError:
            return name in {"localhost", self.host, socket.gethostname(), socket.getfqdn()}
        return True

    def _shows_token(self, headers: Headers, path: str) -> bool:
        assert self.token is not None
        shown = parse_qs(urlsplit(path).query).get("token", [])
        for line in headers.get_all("Cookie"):
            shown += [v for k, _, v in (item.strip().partition("=") for item in line.split(";")) if k == _COOKIE]
        return any(hmac.compare_digest(value.encode(), self.token.encode()) for value in shown)

    def cookie(self) -> str | None:
        """The Set-Cookie line of answers, or None where no token is in use."""
        return None if self.token is None else f"{_COOKIE}={self.token}; HttpOnly; SameSite=Strict; Path=/"

    def wrap(self, inner: Callable[[ServerConnection, Request], Any]) -> Callable[[ServerConnection, Request], Any]:
        """viser's own request handler behind this guard."""

        def guarded(connection: ServerConnection, request: Request) -> Response | None:
            port = connection.transport.get_extra_info("sockname")[1]
            refused = self.refusal(request.headers, request.path, port)
            if refused is not None:
                status, text = refused
                body = text.encode()
                headers = Headers({"Content-Type": "text/plain; charset=utf-8", "Content-Length": str(len(body))})
                return Response(int(status), status.phrase, headers, body)
            response = inner(connection, request)
            if response is not None:
                response.headers["X-Frame-Options"] = "DENY"
                response.headers["X-Content-Type-Options"] = "nosniff"
                response.headers["Referrer-Policy"] = "no-referrer"
                cookie = self.cookie()
                if cookie is not None:
                    response.headers["Set-Cookie"] = cookie
            return response

        return guarded


def _authority(values: list[str]) -> tuple[str, int | None] | None:
    """(host, port) of the one `host:port` text, or None when it is missing, doubled or malformed."""
    if len(values) != 1:
        return None
    try:
        parts = urlsplit(f"//{values[0]}")
        port = parts.port
    except ValueError:
        return None
    if parts.hostname is None or parts.username is not None or parts.path or parts.query:
        return None
    return parts.hostname.lower(), port


@contextmanager
def _guarded_handshake(guard: Guard) -> Iterator[None]:
    """While open, servers that viser starts get `guard` in front (viser calls `serve` through its module)."""
    module = websockets.asyncio.server
    with _patching:
        original = module.serve

        def serve(*args: Any, process_request: Any, **options: Any) -> Any:
            return original(*args, process_request=guard.wrap(process_request), **options)

        module.serve = serve  # type: ignore[assignment,misc]
        try:
            yield
        finally:
            module.serve = original  # type: ignore[misc]


@contextmanager
def _quiet() -> Iterator[None]:
    console = rich.get_console()
    before, console.quiet = console.quiet, True
    try:
        yield
    finally:
        console.quiet = before


def serve(host: str = "127.0.0.1", port: int = 8080, token: str | None = None) -> tuple[viser.ViserServer, str]:
    """Start the server; the port moves up when it is busy.

    Args:
        host: address to bind.
        port: wanted port; 0 lets the system choose.
        token: for addresses other than the loopback one; drawn when None.

    Returns:
        the server and the address to open, with the port that it really got.

    Raises:
        GraspError: the address cannot be bound.
    """
    if not 0 <= port <= 65535:
        raise GraspError(f"--port {port}: ports run from 0 to 65535")
    try:
        infos = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM)
        with socket.socket(infos[0][0], socket.SOCK_STREAM) as probe:
            probe.bind((infos[0][4][0], 0))
    except OSError as error:
        raise GraspError(f"--host {host}: this machine has no such address ({error.strerror or error})") from error
    guard = Guard(host, None if is_loopback(host) else token or secrets.token_urlsafe(16))
    with _guarded_handshake(guard), _quiet():
        server = viser.ViserServer(host=host, port=port, label="grasp-workbench", verbose=False)
    for message in (_messages.ShareUrlRequest, _messages.ShareUrlDisconnect):
        server._websock_server.unregister_handler(message)
    server.gui.configure_theme(dark_mode=True, show_logo=False, show_share_button=False, brand_color=(56, 139, 213))
    shown = socket.gethostname() if host in ("0.0.0.0", "::") else f"[{host}]" if ":" in host else host
    query = "" if guard.token is None else f"/?token={guard.token}"
    return server, f"http://{shown}:{server.get_port()}{query}"
