"""The server of the studio: one page on this machine, and seven routes for it.

Any page that the user visits can send requests to 127.0.0.1. Each request is therefore checked in
this order before its body is read: host, origin, content type, length, token, route.
"""

from __future__ import annotations

import errno
import hmac
import json
import secrets
from collections.abc import Callable, Mapping
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from math import isfinite
from typing import Any, ClassVar

from ..base.errors import ActuatorError, Diagnostic, Unsolvable, UsageError
from ..base.files import read_json
from .choices import ChoiceStudio
from .model import Numbers
from .page import POLICY, page
from .saving import require_name
from .worker import Dropped, Kind, Stop, Worker

LOOPBACK = "127.0.0.1"
LARGEST = 65_536
"""Largest body of a request in bytes."""
MOST_CHANGES, MOST_VALUES, LONGEST_TEXT = 64, 64, 200
"""Largest number of changed numbers, of values of a curve, and of letters of a text."""
TOKEN_BYTES = 24
"""Length of the token: 192 bits."""
TOKEN_HEADER = "X-Studio-Token"
IDLE = 60.0
"""Seconds after which a silent connection is closed."""
HEADERS = {
    "Content-Security-Policy": POLICY,
    "X-Content-Type-Options": "nosniff",
    "X-Frame-Options": "DENY",
    "Referrer-Policy": "no-referrer",
    "Cache-Control": "no-store",
    "Cross-Origin-Opener-Policy": "same-origin",
    "Cross-Origin-Resource-Policy": "same-origin",
}
"""Headers of every answer."""
Body = Mapping[str, Any]
Fault = Callable[[Exception], str]
"""Function that reports an unexpected exception and returns a line for the page."""


class Refused(Exception):
    """A request that is not answered; `status` says why."""

    def __init__(self, status: HTTPStatus, message: str) -> None:
        super().__init__(message)
        self.status = status


class Server(ThreadingHTTPServer):
    """A local server of one studio.

    Parameters
    ----------
    port : port on 127.0.0.1; 0: a free one

    Raises
    ------
    UsageError : the port is taken, or not allowed
    """

    daemon_threads = True
    block_on_close = False
    studio: ChoiceStudio
    worker: Worker
    fault: Fault

    def __init__(self, port: int = 0) -> None:
        try:
            super().__init__((LOOPBACK, port), Handler)
        except OSError as error:
            reason = "is in use" if error.errno == errno.EADDRINUSE else "cannot be used"
            remedy = "choose another, or leave --port out for a free one"
            raise UsageError(Diagnostic(f"--port {port}: {reason}", remedy)) from None
        except OverflowError:
            raise UsageError(Diagnostic(f"--port {port}: is no port", "1 to 65535")) from None
        self.token = secrets.token_urlsafe(TOKEN_BYTES)
        self.hosts = frozenset(f"{name}:{self.server_port}" for name in (LOOPBACK, "localhost"))
        self.origins = frozenset(f"http://{host}" for host in self.hosts)

    @property
    def address(self) -> str:
        """Address of the page, with the token in its fragment, which browsers send nowhere."""
        return f"http://{LOOPBACK}:{self.server_port}/#{self.token}"

    def serve(self, studio: ChoiceStudio, fault: Fault) -> None:
        """Answer requests until Ctrl-C; `fault` reports an unexpected exception."""
        self.studio, self.fault, self.worker = studio, fault, Worker()
        try:
            self.serve_forever(poll_interval=0.2)
        finally:
            self.worker.close()
            self.server_close()

    def handle_error(self, request: Any, client_address: Any) -> None:
        """Ignore connections that break."""


class Handler(BaseHTTPRequestHandler):
    """Answers one request of the page, or refuses it."""

    server: Server
    protocol_version = "HTTP/1.1"
    disable_nagle_algorithm = True
    timeout = IDLE

    def do_GET(self) -> None:
        """Send the page, which contains no data of the design."""
        try:
            self._require_host()
            if self.path != "/":
                raise Refused(HTTPStatus.NOT_FOUND, "no such page")
        except Refused as refused:
            self._refuse(refused)
        else:
            self._send(HTTPStatus.OK, "text/html; charset=utf-8", page())

    def do_POST(self) -> None:
        """Answer a wish."""
        try:
            route, length = self._allowed()
            body = self._body(length)
            answer = self._answer(route, body)
        except Refused as refused:
            self._refuse(refused)
        else:
            self._send(HTTPStatus.OK, "application/json", json.dumps(answer, allow_nan=False))

    def _other(self) -> None:
        """Refuse any other method."""
        try:
            self._require_host()
            raise Refused(HTTPStatus.NOT_FOUND, "no such route")
        except Refused as refused:
            self._refuse(refused)

    do_HEAD = do_PUT = do_PATCH = do_DELETE = do_OPTIONS = do_TRACE = do_CONNECT = _other  # noqa: N815

    # ---- rules, in this order ----

    def _one(self, name: str) -> str | None:
        """A header that appears exactly once, else None."""
        values = self.headers.get_all(name) or []
        return values[0].strip() if len(values) == 1 else None

    def _require_host(self) -> None:
        """Only this machine's own names: a foreign name may have been rebound to 127.0.0.1."""
        if self._one("Host") not in self.server.hosts:
            raise Refused(HTTPStatus.MISDIRECTED_REQUEST, "another host was meant")

    def _allowed(self) -> tuple[str, int]:
        """The route and the length of the body, if the request comes from our own page."""
        self._require_host()
        if self._one("Origin") not in self.server.origins:
            raise Refused(HTTPStatus.FORBIDDEN, "the request comes from another page")
        kind = (self._one("Content-Type") or "").partition(";")[0].strip().lower()
        if kind != "application/json":
            raise Refused(HTTPStatus.UNSUPPORTED_MEDIA_TYPE, "send application/json")
        length = self._one("Content-Length")
        if "Transfer-Encoding" in self.headers or length is None or not _whole(length):
            raise Refused(HTTPStatus.LENGTH_REQUIRED, "state the length")
        if len(length) > len(str(LARGEST)) or int(length) > LARGEST:
            raise Refused(HTTPStatus.REQUEST_ENTITY_TOO_LARGE, f"at most {LARGEST} bytes")
        given = (self._one(TOKEN_HEADER) or "").encode("utf-8", "surrogateescape")
        if not hmac.compare_digest(given, self.server.token.encode()):
            message = "open the address that the studio printed"
            raise Refused(HTTPStatus.UNAUTHORIZED, message)
        if self.path not in ROUTES:
            raise Refused(HTTPStatus.NOT_FOUND, "no such route")
        return self.path, int(length)

    def _body(self, length: int) -> Body:
        try:
            content = self.rfile.read(length)
        except OSError:  # too slow, or gone
            raise Refused(HTTPStatus.REQUEST_TIMEOUT, "the body did not arrive") from None
        if len(content) < length:
            raise Refused(HTTPStatus.BAD_REQUEST, "the body is cut off")
        try:
            body = read_json(content.decode())
        except ValueError as error:
            raise _unfit(f"the wish is not JSON: {error}") from None
        if not isinstance(body, dict):
            raise _unfit("a wish is an object")
        return body

    def _answer(self, route: str, body: Body) -> Any:
        try:
            return ROUTES[route](self.server, _Wish(body))
        except Dropped:
            return {"dropped": True}
        except Unsolvable:
            return {"infeasible": True}
        except ActuatorError as error:
            lines = [str(fault).partition("\n")[0] for fault in error.diagnostics]
            raise _unfit("\n".join(lines)) from None
        except Refused:
            raise
        except Exception as error:
            line = self.server.fault(error)
            raise Refused(HTTPStatus.INTERNAL_SERVER_ERROR, line) from None

    # ---- answers ----

    def _refuse(self, refused: Refused) -> None:
        """Say why in one line, and close: an unread body must not become the next request."""
        self.close_connection = True
        self._send(refused.status, "application/json", json.dumps({"error": str(refused)}))

    def _send(self, status: HTTPStatus, kind: str, text: str) -> None:
        content = text.encode()
        self.send_response(status)
        self.send_header("Content-Type", kind)
        self.send_header("Content-Length", str(len(content)))
        for name, value in HEADERS.items():
            self.send_header(name, value)
        if self.close_connection:
            self.send_header("Connection", "close")
        self.end_headers()
        if self.command != "HEAD":
            self.wfile.write(content)

    def send_error(self, code: int, message: str | None = None, explain: str | None = None) -> None:
        """Refuse a request that is no proper HTTP, without repeating any of it."""
        self.close_connection = True
        status = HTTPStatus(code)
        self._send(status, "application/json", json.dumps({"error": status.phrase}))

    def version_string(self) -> str:
        """Name of the server, without versions."""
        return "actuator-opt"

    def log_message(self, format: str, *args: Any) -> None:
        """Log nothing: a request line may be hostile, and Ctrl-C prints what matters."""


class _Wish:
    """The body of a request; every access checks type and size, and unknown keys are refused."""

    KEYS: ClassVar = frozenset(
        {"tab", "changes", "describe", "whole", "explain", "paths", "draw", "path"}
        | {"values", "search", "best", "name", "replacing"}
    )

    def __init__(self, body: Body) -> None:
        unknown = next((key for key in body if key not in self.KEYS), None)
        if unknown is not None:
            raise _unfit("a wish has an unknown key")
        self._body = body
        self.tab = self.word("tab")

    def word(self, key: str, default: str = "") -> str:
        value = self._body.get(key, default)
        if not isinstance(value, str) or len(value) > LONGEST_TEXT:
            raise _unfit(f"{key}: a text of at most {LONGEST_TEXT} letters")
        return value

    def flag(self, key: str) -> bool:
        value = self._body.get(key, False)
        if not isinstance(value, bool):
            raise _unfit(f"{key}: true or false")
        return value

    @property
    def changes(self) -> Numbers:
        """Changed numbers by PATH."""
        value = self._body.get("changes", {})
        if not isinstance(value, dict) or len(value) > MOST_CHANGES:
            raise _unfit(f"changes: at most {MOST_CHANGES} numbers by PATH")
        for path, number in value.items():
            text = isinstance(number, str) and len(number) <= LONGEST_TEXT
            if len(path) > LONGEST_TEXT or not (text or _finite(number)):
                raise _unfit("changes: a number, or a text with a unit, for each PATH")
        return value

    @property
    def paths(self) -> list[str]:
        """PATHs to price."""
        value = self._body.get("paths")
        fit = isinstance(value, list) and len(value) <= MOST_CHANGES
        if not fit or not all(isinstance(x, str) and len(x) <= LONGEST_TEXT for x in value or ()):
            raise _unfit(f"paths: at most {MOST_CHANGES} PATHs")
        return list(value or ())

    @property
    def values(self) -> list[float]:
        """Values of a curve."""
        value = self._body.get("values")
        fit = isinstance(value, list) and 0 < len(value) <= MOST_VALUES
        if not fit or not all(map(_finite, value or ())):
            raise _unfit(f"values: 1 to {MOST_VALUES} numbers")
        return [float(x) for x in value or ()]


def _solve(server: Server, wish: _Wish) -> Any:
    changes, describe, search = wish.changes, wish.flag("describe"), wish.flag("search")
    explain = wish.flag("explain")
    whole = wish.flag("whole") or explain or search
    kind: Kind = "prices" if whole else "solve"
    studio = server.studio

    def work(stop: Stop) -> Any:
        more = {"design": studio.describe(changes, stop)} if describe else {}
        if whole:
            return studio.solve(changes, stop, explain=explain, search=search) | more
        return studio.first(changes, stop) | more

    return server.worker.do(work, tab=wish.tab, kind=kind)


def _prices(server: Server, wish: _Wish) -> Any:
    changes, paths, draw = wish.changes, wish.paths, wish.flag("draw")
    return server.worker.do(
        lambda stop: server.studio.prices(changes, paths, stop, draw=draw),
        tab=wish.tab,
        kind="prices",
    )


def _curve(server: Server, wish: _Wish) -> Any:
    changes, path, values = wish.changes, wish.word("path"), wish.values
    search, best = wish.flag("search"), wish.word("best")
    return server.worker.do(
        lambda stop: server.studio.curve(changes, path, values, stop, search=search, best=best),
        tab=wish.tab,
        kind="curve",
    )


def _cycle(server: Server, wish: _Wish) -> Any:
    changes, name = wish.changes, wish.word("name")
    return server.worker.do(
        lambda stop: server.studio.cycle(changes, name, stop), tab=wish.tab, kind="cycle"
    )


def _save(server: Server, wish: _Wish) -> Any:
    changes, name = wish.changes, require_name(wish.word("name"))
    replacing = wish.word("replacing") or None
    saved = server.worker.do(lambda _: server.studio.save(changes, name, replacing))
    return {"name": saved.name, "sha256": saved.sha256, "written": saved.written}


def _report(server: Server, wish: _Wish) -> Any:
    changes = wish.changes
    return {"files": server.worker.do(lambda _: server.studio.report(changes))}


ROUTES: Mapping[str, Callable[[Server, _Wish], Any]] = {
    "/api/solve": _solve,
    "/api/prices": _prices,
    "/api/curve": _curve,
    "/api/cycle": _cycle,
    "/api/save": _save,
    "/api/report": _report,
}
"""All routes besides the page itself."""


def _whole(text: str) -> bool:
    return text.isascii() and text.isdigit()


def _finite(value: object) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and isfinite(value)


def _unfit(message: str) -> Refused:
    return Refused(HTTPStatus.UNPROCESSABLE_ENTITY, message)
