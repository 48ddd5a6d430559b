"""The documentation without Sphinx: complete entries, known names, words, links, checks."""

from __future__ import annotations

import doctest
import re

import pytest
from docs_pages import DOCS, checks, markdown, reference_book, runs

ROLE = re.compile(r"\{(\w+)\}`(?:[^`<]*<)?([^`<>]+)>?`")


def test_every_entry_is_complete_and_every_name_known():
    """An entry without definition, unit or source raises; a role names an entry, a test a test."""
    pytest.importorskip("docutils", reason="extra docs; the build checks the same")
    from extensions.models import test_exists
    from extensions.names import known_label
    from extensions.roles import Named

    labels = reference_book().labels
    unknown = []
    for name, path in checks.written().items():
        if path.suffix == ".md":
            for number, line in checks.prose(path.read_text("utf-8"), roles=True):
                for role, word in ROLE.findall(line):
                    if role == "test":
                        found = test_exists(word)
                    else:
                        found = role not in labels or known_label(labels, role, word)
                        found = found or (role == "model" and Named.elsewhere(word))
                    unknown += [] if found else [f"{name}:{number}: {role} {word}"]
    assert unknown == []


def test_pages_use_the_terms_of_the_project():
    """Spelling and plain English of the pages written by hand."""
    assert checks.words() == []


def test_links_between_pages():
    """A link leads to a page written by hand, a generated page, or a file of the sources."""
    pages = {*checks.written(), *(f"{name}.md" for name in reference_book().pages)}
    lost = []
    for name, path in checks.written().items():
        if path.suffix != ".md" or path.is_relative_to(DOCS) is False:
            continue
        for link in re.findall(r"\]\(([^)#:]+)(?:#[^)]*)?\)", path.read_text("utf-8")):
            target = (DOCS / link[1:]) if link.startswith("/") else (path.parent / link)
            if target.resolve().relative_to(DOCS).as_posix() not in pages:
                lost.append(f"{name}: {link}")
    for name in ("README.md", "CONTRIBUTING.md"):
        text = (DOCS.parent / name).read_text("utf-8")
        lost += [
            f"{name}: {link}"
            for link in re.findall(r"\]\(([^)#:]+)(?:#[^)]*)?\)", text)
            if not (DOCS.parent / link).exists()
        ]
    assert lost == []


def test_faults_of_pages_are_seen(tmp_path):
    """Outside hosts, broken links and places, and a page that no link leads to."""
    pages = {
        "index.html": '<a href="good.html#here"></a><a href="good.html#no"></a><a '
        'href="x.html"></a><a href="https://doi.org/10.1"></a><script src="https://a.b/c.js"></script>',
        "good.html": '<p id="here" style="background: url(//a.b/c.png)"></p>',
        "alone.html": '<link rel="stylesheet" href="style.css"><img src="a.png">',
    }
    for name, text in pages.items():
        (tmp_path / name).write_text(text, encoding="utf-8")
    (tmp_path / "style.css").write_text('@import "https://a.b/c.css";', encoding="utf-8")
    faults = "\n".join(checks.html(tmp_path))
    for fault in (
        "index.html: loads https://a.b/c.js from outside",
        "index.html: no place for the link good.html#no",
        "index.html: no file for the link x.html",
        "good.html: loads background: url(//a.b/c.png) from outside",
        "style.css: loads a style or font from outside",
        "alone.html: no link from the index leads here",
        "alone.html: no file a.png",
    ):
        assert fault in faults
    assert len(faults.splitlines()) == 7


def test_run_blocks(monkeypatch, tmp_path):
    """Blocks in blocks are found, unknown options refused; another text has another key."""
    pytest.importorskip("markdown_it")
    text = (
        "a\n\n```{run} console\n:exit: 1\n$ x\n```\n\n````{note}\n```{run} python\ny\n```\n````\n"
    )
    found = runs.blocks(text)
    assert [(b.kind, dict(b.options), b.text) for b in found] == [
        ("console", {"exit": "1"}, "$ x\n"), ("python", {}, "y\n"),
    ]  # fmt: skip
    assert runs.key(found, "program") != runs.key(found[:1], "program")
    assert runs.key(found, "program") != runs.key(found, "other program")
    for wrong in (":colour: 1\n$ x", "x"):
        with pytest.raises(runs.RunFault):
            runs._commands(runs.blocks(f"```{{run}} console\n{wrong}\n```\n")[0].text)


@pytest.mark.parametrize("module", [markdown, runs])
def test_examples(module):
    """Examples in docstrings of the build."""
    assert doctest.testmod(module).failed == 0
