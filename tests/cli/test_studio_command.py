"""The command `studio`: bad input, the private file that opens the browser, Ctrl-C."""

from __future__ import annotations

import socket
import stat
import webbrowser
from contextlib import closing
from pathlib import Path

import pytest
from cli_runner import DESIGNS, run

from actuator_opt.cli import studio as command

STEEL = DESIGNS / "steel_baseline.yaml"


def test_a_broken_design_is_refused_as_check_does(tmp_path):
    """The same lines, exit code 3."""
    file = tmp_path / "broken.yaml"
    file.write_text(STEEL.read_text("utf-8").replace("stroke:", "strok:"), "utf-8")
    done, checked = run("studio", str(file), "--no-browser"), run("check", str(file))
    assert (done.code, done.out) == (3, "")
    assert done.err.splitlines() == checked.err.splitlines()
    assert ":" in done.err


@pytest.mark.parametrize(
    ("name", "code", "words"),
    [
        ("course_cylinder.yaml", 3, "the design has no variables"),
        ("knee_choices.yaml", 2, "choices"),
        ("missing.yaml", 3, "no such file"),
    ],
)
def test_what_the_studio_cannot_open_is_said(name, code, words):
    """Nothing free, choices, no file: one fault, and what to do."""
    done = run("studio", str(DESIGNS / name), "--no-browser")
    assert (done.code, done.out) == (code, "")
    assert words in done.err


def test_standard_input_is_no_file():
    """There is no folder to save to."""
    done = run("studio", "-", "--no-browser")
    assert done.code == 2
    assert "name a design file" in done.err


def test_a_taken_port_is_said():
    """Before anything is solved; exit code 2."""
    with closing(socket.create_server(("127.0.0.1", 0))) as taken:
        port = taken.getsockname()[1]
        done = run("studio", str(STEEL), "--no-browser", "--port", str(port))
    assert done.code == 2
    assert f"--port {port}: is in use" in done.err


class Browser(webbrowser.BaseBrowser):
    """Notes which file it was given, its mode and its text."""

    def open(self, url, new=0, autoraise=True):
        """Read the file as a browser would."""
        file = Path(url.removeprefix("file://"))
        self.seen = url, stat.S_IMODE(file.stat().st_mode), file.read_text("utf-8"), file
        return True


def test_the_browser_gets_a_private_file(monkeypatch):
    """Other users see the command line of the browser: it has no key; the file goes at the end."""
    browser = Browser()
    monkeypatch.setattr(webbrowser, "get", lambda: browser)
    with command._browser("http://127.0.0.1:9/#key", quiet=False):
        url, mode, text, file = browser.seen
        assert "key" not in url
        assert mode == 0o600
        assert 'content="0; url=http://127.0.0.1:9/#key"' in text
    assert not file.exists()


def test_without_a_browser_the_address_is_enough(monkeypatch, capsys):
    """Neither a missing browser nor one for a terminal ends the studio."""

    def missing():
        raise webbrowser.Error("no browser")

    for get in (missing, lambda: webbrowser.GenericBrowser("w3m")):
        monkeypatch.setattr(webbrowser, "get", get)
        with command._browser("http://127.0.0.1:9/#key", quiet=False):
            assert "open the address above" in capsys.readouterr().err
