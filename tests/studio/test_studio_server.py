"""Attacks on the server: each rule of the studio's security, tried as a hostile page would."""

from __future__ import annotations

import http.client
import json
import os
import re
import socket
import threading
from contextlib import closing

import pytest

from actuator_opt.base.errors import Diagnostic, InputError, Unsolvable, UsageError
from actuator_opt.studio import server as module
from actuator_opt.studio.page import page
from actuator_opt.studio.saving import Saved
from actuator_opt.studio.server import HEADERS, LARGEST, TOKEN_HEADER, Server
from actuator_opt.studio.worker import Dropped


class Recorder:
    """In place of the studio: notes what reaches it, and answers or fails as told."""

    def __init__(self):
        self.calls, self.fails = [], None

    def _note(self, *call):
        self.calls.append(call)
        if self.fails is not None:
            raise self.fails
        return {"fine": True}

    def describe(self, changes, stop):
        """As `ChoiceStudio.describe`."""
        return {"name": "x"}

    def first(self, changes, stop):
        """As `ChoiceStudio.first`."""
        return self._note("first", dict(changes))

    def solve(self, changes, stop, *, explain=False, search=False):
        """As `ChoiceStudio.solve`."""
        return self._note("solve", dict(changes), explain, search)

    def cycle(self, changes, name, stop):
        """As `ChoiceStudio.cycle`."""
        return self._note("cycle", dict(changes), name)

    def prices(self, changes, paths, stop, *, draw=False):
        """As `Studio.prices`."""
        return self._note("prices", dict(changes), paths, draw)

    def curve(self, changes, path, values, stop, *, search=False, best=""):
        """As `Studio.curve`."""
        return self._note("curve", dict(changes), path, values, search, best)

    def save(self, changes, name, replacing):
        """As `Studio.save`."""
        self._note("save", dict(changes), name, replacing)
        return Saved(name, "0" * 64, written=True)

    def report(self, changes):
        """As `Studio.report`."""
        self._note("report", dict(changes))
        return ["reports/x.pdf"]


@pytest.fixture(scope="module")
def running():
    """A server with a recorder, for all tests."""
    server, studio = Server(), Recorder()
    thread = threading.Thread(target=server.serve, args=(studio, lambda error: "a fault"))
    thread.start()
    yield server, studio
    server.shutdown()
    thread.join(5)


@pytest.fixture
def served(running):
    """The server, with nothing recorded yet."""
    server, studio = running
    studio.calls, studio.fails = [], None
    return server, studio


def usual(server):
    """Headers of our own page."""
    return {
        "Host": f"127.0.0.1:{server.server_port}",
        "Origin": f"http://127.0.0.1:{server.server_port}",
        "Content-Type": "application/json",
        TOKEN_HEADER: server.token,
    }


def sent(server, method="POST", path="/api/solve", body=b"{}", drop=(), twice=(), **headers):
    """Send a request with changed headers; return status, headers and JSON or text."""
    given = {**usual(server), **{key.replace("_", "-"): text for key, text in headers.items()}}
    if method == "POST":
        given.setdefault("Content-Length", str(len(body)))
    lines = [f"{method} {path} HTTP/1.1"]
    lines += [f"{key}: {text}" for key, text in given.items() if key not in drop]
    lines += [f"{key}: {given[key]}" for key in twice]
    raw = "\r\n".join([*lines, "", ""]).encode("latin-1") + body
    with closing(socket.create_connection(("127.0.0.1", server.server_port), 5)) as link:
        link.sendall(raw)
        answer = http.client.HTTPResponse(link, method=method)
        answer.begin()
        text = answer.read().decode()
    kind = answer.getheader("Content-Type")
    return answer.status, answer.headers, json.loads(text) if "json" in kind and text else text


def test_our_own_page_is_answered(served):
    """With all headers, by both names of this machine."""
    server, studio = served
    wish = json.dumps({"changes": {"cylinder.stroke": "112 mm"}, "tab": "a"}).encode()
    assert sent(server, body=wish)[::2] == (200, {"fine": True})
    assert studio.calls == [("first", {"cylinder.stroke": "112 mm"})]
    local = f"localhost:{server.server_port}"
    assert sent(server, Host=local, Origin=f"http://{local}")[0] == 200


def test_bound_to_loopback_only(served):
    """No other address of this machine listens, and there is no option for more."""
    server, _ = served
    assert server.server_address[0] == "127.0.0.1"
    assert server.socket.getsockname()[0] == "127.0.0.1"


@pytest.mark.parametrize(
    "host",
    ["evil.example", "evil.example:{port}", "127.0.0.1", "127.0.0.1:1", "localhost.evil:{port}",
     "127.0.0.1.:{port}", "[::1]:{port}", "0.0.0.0:{port}", "127.0.0.1:{port}@evil", ""],
)  # fmt: skip
@pytest.mark.parametrize("method", ["GET", "POST", "HEAD", "OPTIONS"])
def test_rebound_names_are_refused(served, host, method):
    """DNS rebinding: the browser believes that our server is evil.example."""
    server, studio = served
    path = "/" if method == "GET" else "/api/solve"
    status, _, _ = sent(server, method, path, Host=host.format(port=server.server_port))
    assert (status, studio.calls) == (421, [])


def test_no_host_and_two_hosts_are_refused(served):
    """Of two hosts a proxy may believe the other one."""
    server, studio = served
    assert sent(server, drop=["Host"])[0] == 421
    assert sent(server, twice=["Host"])[0] == 421
    assert sent(server, "GET", "/", twice=["Host"])[0] == 421
    assert studio.calls == []


@pytest.mark.parametrize(
    "origin",
    ["http://evil.example", "null", "https://127.0.0.1:{port}", "http://127.0.0.1", "http://127.0.0.1:1",
     "http://127.0.0.1:{port}.evil.example", "http://127.0.0.1:{port}/", "file://", ""],
)  # fmt: skip
def test_other_pages_are_refused(served, origin):
    """Cross-site requests, sandboxed frames, other ports and schemes."""
    server, studio = served
    status, headers, _ = sent(server, Origin=origin.format(port=server.server_port))
    assert (status, studio.calls) == (403, [])
    assert "Access-Control-Allow-Origin" not in headers


def test_no_origin_and_two_origins_are_refused(served):
    """Browsers always state one."""
    server, studio = served
    assert sent(server, drop=["Origin"])[0] == 403
    assert sent(server, twice=["Origin"])[0] == 403
    assert studio.calls == []


@pytest.mark.parametrize(
    "kind", ["text/plain", "application/x-www-form-urlencoded", "multipart/form-data", "", "json"]
)
def test_forms_of_other_pages_are_refused(served, kind):
    """These types need no preflight, so any page can send them."""
    server, studio = served
    assert sent(server, Content_Type=kind)[0] == 415
    assert studio.calls == []


def test_the_length_is_stated_and_small(served):
    """One plain number, and no chunks."""
    server, studio = served
    assert sent(server, drop=["Content-Length"])[0] == 411
    assert sent(server, twice=["Content-Length"])[0] == 411
    for length in ("-1", "+2", "2 2", "0x2", "²", ""):
        assert sent(server, Content_Length=length)[0] == 411
    assert sent(server, Transfer_Encoding="chunked")[0] == 411
    for length in (str(LARGEST + 1), "9" * 5000):
        assert sent(server, Content_Length=length, body=b"")[0] == 413
    assert studio.calls == []
    body = b'{"changes": {}}'.ljust(LARGEST)
    assert sent(server, body=body)[0] == 200


@pytest.mark.parametrize("change", ["", "x", "{token}x", "{half}", "{upper}", "é"])
def test_the_token_is_needed(served, change):
    """Whole, exact, and nothing more."""
    server, studio = served
    token = server.token
    wrong = change.format(token=token, half=token[:-1], upper=token.swapcase())
    assert sent(server, **{TOKEN_HEADER: wrong})[0] == 401
    assert studio.calls == []


def test_no_token_two_tokens_and_tokens_elsewhere_are_refused(served):
    """Neither the address nor a cookie counts."""
    server, studio = served
    assert sent(server, drop=[TOKEN_HEADER])[0] == 401
    assert sent(server, twice=[TOKEN_HEADER])[0] == 401
    path = f"/api/solve?token={server.token}"
    assert sent(server, path=path, drop=[TOKEN_HEADER], Cookie=server.token)[0] == 401
    assert studio.calls == []


def test_the_token_is_long_fresh_and_compared_in_constant_time(served, monkeypatch):
    """192 bits, another at each start."""
    server, _ = served
    assert module.TOKEN_BYTES * 8 == 192
    assert len(server.token) == 32
    with Server() as other:
        assert other.token != server.token
    compared = []
    real = module.hmac.compare_digest
    monkeypatch.setattr(
        module.hmac, "compare_digest", lambda a, b: compared.append(b) or real(a, b)
    )
    sent(server)
    assert compared == [server.token.encode()]


@pytest.mark.parametrize(
    "path",
    ["/api/", "/api/solve/", "/api/solve?x", "/api/../api/solve", "/API/solve", "/api/%73olve",
     "/../../etc/passwd", "/etc/passwd", "//api/solve/..", "http://evil.example/api/solve",
     "/main.js"],
)  # fmt: skip
def test_only_the_fixed_routes_exist(served, path):
    """No other spelling of a route leads to it."""
    server, studio = served
    assert sent(server, path=path)[0] == 404
    assert sent(server, "GET", path)[0] == 404
    assert studio.calls == []


def test_there_are_seven_routes_and_reading_changes_nothing(served):
    """GET gives the page only, not even with the token; other methods give nothing."""
    server, studio = served
    assert len(module.ROUTES) + 1 == 7
    for path in module.ROUTES:
        for method in ("GET", "HEAD", "PUT", "PATCH", "DELETE", "OPTIONS", "TRACE"):
            status, headers, _ = sent(server, method, path)
            assert status == 404
            assert not [name for name in headers if name.lower().startswith("access-control")]
    assert sent(server, "BREW", "/")[0] == 501
    assert studio.calls == []


def test_no_path_of_a_client_reaches_the_disk(served, monkeypatch):
    """Neither a request nor a refusal opens a file."""
    server, _ = served
    page()
    opened = []
    monkeypatch.setattr("builtins.open", lambda *a, **k: opened.append(a))
    monkeypatch.setattr(os, "open", lambda *a, **k: opened.append(a))
    for path in ("/", "/etc/passwd", "/../server.py"):
        sent(server, "GET", path)
        sent(server, path=path)
    assert opened == []


@pytest.mark.parametrize(
    "body",
    [b"", b"[]", b"3", b"{", b"\xff", b'{"a": 1}', b'{"changes": []}', b'{"changes": {"x": NaN}}',
     b'{"changes": {"x": 1e999}}', b'{"changes": {"x": true}}', b'{"changes": {"x": null}}',
     b'{"changes": {"x": [1]}}', b'{"changes": {"x": "%s"}}' % (b"9" * 300), b"[" * 60_000,
     b'{"changes": {"%s": 1}}' % (b"p" * 300), b'{"tab": 3}', b'{"explain": 1}', b'{"whole": 1}',
     json.dumps({"changes": {f"x{k}": 1 for k in range(65)}}).encode()],
)  # fmt: skip
def test_unfit_wishes_are_refused_by_a_sentence(served, body):
    """Not JSON, wrong types, not finite, too many, too long."""
    server, studio = served
    status, _, answer = sent(server, body=body)
    assert (status, studio.calls) == (422, [])
    assert answer["error"]
    assert "Traceback" not in answer["error"]


@pytest.mark.parametrize(
    ("path", "wish"),
    [("/api/prices", {}), ("/api/prices", {"paths": "x"}), ("/api/prices", {"paths": [1]}),
     ("/api/prices", {"paths": ["x"] * 65}), ("/api/curve", {"path": "x", "values": []}),
     ("/api/curve", {"path": 1, "values": [1]}), ("/api/curve", {"path": "x", "values": ["1"]}),
     ("/api/curve", {"path": "x", "values": [1] * 65}), ("/api/save", {}),
     ("/api/cycle", {"name": 1}), ("/api/cycle", {"name": "x" * 201}),
     ("/api/cycle", {"cycle": "walk"}), ("/api/solve", {"search": 1}),
     ("/api/solve", {"words": {"rod.material": "ti_6al4v"}}),
     ("/api/solve", {"changes": {"rod.material": ["ti_6al4v"]}}),
     ("/api/solve", {"changes": {"rod.material": None}}),
     ("/api/save", {"name": 1}),
     ("/api/save", {"name": "../x.yaml"}), ("/api/save", {"name": "x.yaml", "replacing": 3})],
)  # fmt: skip
def test_other_unfit_wishes_are_refused(served, path, wish):
    """The same for prices, curves and names of files."""
    server, studio = served
    assert sent(server, path=path, body=json.dumps(wish).encode())[0] == 422
    assert studio.calls == []


def test_every_route_takes_what_it_needs(served):
    """The arguments reach the studio as they were sent."""
    server, studio = served
    for path, wish in (
        ("/api/solve", {"describe": True}),
        ("/api/solve", {"whole": True}),
        ("/api/solve", {"explain": True}),
        ("/api/solve", {"search": True}),
        ("/api/prices", {"paths": ["x"], "draw": True}),
        ("/api/curve", {"path": "x", "values": [1, 2.5], "search": True, "best": "y"}),
        ("/api/cycle", {"name": "walk"}),
        ("/api/save", {"name": "x.yaml"}),
        ("/api/report", {}),
    ):
        assert sent(server, path=path, body=json.dumps(wish).encode())[0] == 200
    assert studio.calls == [
        ("first", {}), ("solve", {}, False, False), ("solve", {}, True, False),
        ("solve", {}, False, True), ("prices", {}, ["x"], True),
        ("curve", {}, "x", [1.0, 2.5], True, "y"), ("cycle", {}, "walk"),
        ("save", {}, "x.yaml", None), ("report", {}),
    ]  # fmt: skip


@pytest.mark.parametrize(
    ("fault", "status", "answer"),
    [
        (InputError(Diagnostic("odd", "mend it", path="a.b")), 422, {"error": "a.b: odd; mend it"}),
        (UsageError(Diagnostic("is no use")), 422, {"error": "is no use"}),
        (Unsolvable(Diagnostic("none")), 200, {"infeasible": True}),
        (Dropped(), 200, {"dropped": True}),
        (ZeroDivisionError("<script>"), 500, {"error": "a fault"}),
    ],
)  # fmt: skip
def test_faults_become_answers(served, fault, status, answer):
    """A fault has its status, and the next wish is answered."""
    server, studio = served
    studio.fails = fault
    assert sent(server)[::2] == (status, answer)
    studio.fails = None
    assert sent(server)[0] == 200


@pytest.mark.parametrize(
    ("method", "path", "headers"),
    [("GET", "/", {}), ("GET", "/none", {}), ("POST", "/api/solve", {}), ("PUT", "/", {}),
     ("POST", "/api/solve", {"Origin": "null"}), ("GET", "/", {"Host": "evil"})],
)  # fmt: skip
def test_every_answer_carries_the_policy(served, method, path, headers):
    """Refusals, too."""
    _, given, _ = sent(served[0], method, path, **headers)
    for name, text in HEADERS.items():
        assert given[name] == text
    policy = dict(x.split(" ", 1) for x in given["Content-Security-Policy"].split("; "))
    assert policy["default-src"] == policy["frame-ancestors"] == policy["form-action"] == "'none'"
    assert policy["connect-src"] == "'self'"
    assert re.fullmatch(r"'sha256-[\w+/]{43}='", policy["script-src"])
    assert re.fullmatch(r"'sha256-[\w+/]{43}='", policy["style-src"])
    assert given["X-Content-Type-Options"] == "nosniff"
    assert given["Referrer-Policy"] == "no-referrer"
    assert given["Cache-Control"] == "no-store"
    assert "Python" not in given["Server"]


def test_a_refused_body_is_no_second_request(served):
    """The unread body of a refused request is not taken as the next request of the connection."""
    server, studio = served
    hidden = b"POST /api/report HTTP/1.1\r\n" + "".join(
        f"{key}: {text}\r\n" for key, text in usual(server).items()
    ).encode() + b"Content-Length: 2\r\n\r\n{}"  # fmt: skip
    status, headers, _ = sent(server, Origin="null", body=hidden)
    assert (status, headers["Connection"], studio.calls) == (403, "close", [])


def test_a_cut_body_is_refused(served, monkeypatch):
    """A body that never arrives holds the connection for a short time only."""
    server, studio = served
    monkeypatch.setattr(module.Handler, "timeout", 0.05)
    assert sent(server, Content_Length="50")[0] in (400, 408)
    assert studio.calls == []


def test_the_page_holds_no_data_and_no_way_to_inject(served):
    """The page needs no token, so it tells nothing; texts reach it as text only."""
    server, _ = served
    status, _, text = sent(server, "GET", "/", drop=["Origin", TOKEN_HEADER])
    assert status == 200
    assert server.token not in text
    assert len(text.encode()) < 96_000
    injections = "innerHTML outerHTML insertAdjacent document.write eval( Function("
    assert not [word for word in injections.split() if word in text]
    assert not re.search(r"\b(?:src|href)=[\"'](?!data:,)", text)
    assert set(re.findall(r"https?://[\w.]+", text)) == {"http://www.w3.org"}
    assert not re.search(r"<[^>]* (?:on\w+|style)=", text.partition("<script>")[0])


def test_a_taken_port_is_said(served):
    """With its number, and exit code 2."""
    server, _ = served
    with pytest.raises(UsageError, match=f"--port {server.server_port}: is in use") as refused:
        Server(server.server_port)
    assert refused.value.exit_code == 2


def test_small_answers_are_not_held_back(served):
    """Nagle's algorithm is off: it would delay small answers by 40 ms."""
    assert module.Handler.disable_nagle_algorithm
    assert module.Handler.protocol_version == "HTTP/1.1"
