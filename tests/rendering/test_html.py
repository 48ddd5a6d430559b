"""A page as HTML: whole by itself, balanced, safe with hostile text, the numbers of paper."""

import re
from html.parser import HTMLParser
from importlib import import_module
from pathlib import Path

import pytest
from cases.one_line import one_line
from cli_runner import run

import actuator_opt as ao
from actuator_opt.api import results
from actuator_opt.base.tables import Displayed
from actuator_opt.rendering import html
from actuator_opt.rendering.blocks import (
    Bar,
    Column,
    Drawing,
    Flag,
    Listing,
    Notes,
    Origin,
    Page,
    Pair,
    Row,
    Share,
    Slot,
    Status,
    Table,
    TerminalFigure,
    Tile,
    Verdict,
)
from actuator_opt.rendering.ink import Ink

HOSTILE = "<script>alert('x')</script> & \"q\" \u202e \x1b[31m</style></pre>"
VOID = {"meta", "br", "wbr", "rect", "path", "circle"}


class Balance(HTMLParser):
    """Tags of a document; raises where one closes that did not open last."""

    def __init__(self):
        super().__init__()
        self.open, self.seen, self.words = [], [], []

    def handle_starttag(self, tag, attrs):
        """Remember an opened tag."""
        self.seen.append((tag, dict(attrs)))
        if tag not in VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag, attrs):
        """Remember a tag that closes itself."""
        self.seen.append((tag, dict(attrs)))

    def handle_endtag(self, tag):
        """Close the tag opened last."""
        assert self.open, f"</{tag}> closes nothing"
        assert self.open.pop() == tag

    def handle_data(self, data):
        """Remember the words on the page."""
        if self.open and self.open[-1] not in ("style", "title"):
            self.words.append(data)


def ink(words="a curve"):
    """A small drawing."""
    made = Ink(60.0, 20.0)
    made.line((0.0, 0.0), (60.0, 20.0), dash=(1.0, 0.5))
    made.text(10.0, 10.0, words, angle=30.0, bold=True, halo=True, anchor="center")
    return made


def page(words="plain"):
    """A page with every kind of block and cell."""
    columns = [
        Column("name", "left", 1.0, mono=True),
        Column("value", "right", strong=True, style="state"),
        Column("mark"),
        Column("seen on the terminal", on="terminal"),
    ]
    rows = [
        Row((words, "12.3 N", Status("met"), "hidden"), "met"),
        Row(("barrel.wall", "1.0", Bar(-0.3, met=False), "hidden"), "missed"),
        (words, "2", Bar(None), "hidden"),
        (["seals.", "piston"], "3", Slot(0.4, "lower"), "hidden"),
        ("share", "4", Share(0.5), "hidden"),
        ("sum", "10", Flag(words, raised=True), "hidden"),
    ]
    return Page(
        name=words,
        kind="Test page",
        verdict=Verdict("checks", f"MET {words}", [words], [words]),
        sentence=words,
        tiles=[Tile(words, "1", words, words, "missed")],
        hero=lambda room: ink(words),
        items=[(1, words, words)],
        blocks=[
            Table(words, columns, rows, note=words, total=1),
            Pair([[Notes(words, [words])], [Drawing(words, ink(words), words)]]),
            Notes("hidden", ["hidden"], on="terminal"),
            TerminalFigure("hidden", [(0.0, 1.0), (1.0, 2.0)]),
            Listing(words, f"a: 1\n{words}\n"),
        ],
        lists_input=True,
    )


def origin(words="plain"):
    """Where the page comes from."""
    return Origin(f"name: {words}\n", f"{words}.yaml", f"actuator-opt report {words}", "0" * 32)


@pytest.mark.parametrize("words", ["plain", HOSTILE, "", "膝 ⌀ µ", "x" * 4000])
def test_a_document_is_balanced_and_needs_nothing_else(words):
    """Every tag is closed; no script, no link, no address; whatever the texts hold."""
    text = html.document(page(words), origin(words))
    seen = Balance()
    seen.feed(text)
    seen.close()
    assert not seen.open
    assert not {tag for tag, _ in seen.seen} & {"script", "link", "img", "iframe", "object"}
    assert not re.search(r"url\(|@import|(?:src|href)=", text)
    assert "\x1b" not in text
    assert "\u202e" not in text
    assert "hidden" not in "".join(seen.words)


def test_hostile_words_stay_words():
    """What looks like markup in a name is shown as it is written."""
    seen = Balance()
    seen.feed(html.document(page(HOSTILE), origin(HOSTILE)))
    assert sum("<script>alert('x')</script>" in words for words in seen.words) > 10


def test_equal_pages_are_equal_bytes():
    """Nothing of the moment or the machine is in a page."""
    assert html.document(page(), origin()) == html.document(page(), origin())


def test_the_cells_of_paper_are_there():
    """Numbers, marks and totals of a table; a column of the terminal is left out."""
    text = html.document(page("plain"), origin())
    for words in ("12.3 N", "✔ met", "barrel.<wbr>wall", "seals.<wbr>piston", 'class="total rule"'):
        assert words in text
    assert "seen on the terminal" not in text
    assert text.count("<svg") == 5  # the large figure, a drawing, a bar, a slot, a share


def test_dark_light_and_print_have_their_colours():
    """Both looks of a screen are declared, and print is always light."""
    text = html.document(page(), origin())
    assert "@media (prefers-color-scheme:dark)" in text
    assert "@media print" in text
    assert 'name="color-scheme" content="light dark"' in text


def test_a_fragment_has_no_origin():
    """A notebook shows the page without command and without the design file."""
    text = html.fragment(page())
    assert "<html" not in text
    assert "actuator-opt report" not in text
    assert "Input:" not in text


def test_files_are_whole(tmp_path):
    """One file, its bytes those of the document."""
    (file,) = html.write(page(), origin(), folder=tmp_path / "new", stem="knee")
    assert file.path == tmp_path / "new" / "knee.html"
    assert file.path.read_text("utf-8") == html.document(page(), origin())


KNEE = Path(__file__).parents[2] / "designs" / "knee_bonded.yaml"


def test_every_result_is_shown_in_a_notebook():
    """Each type of result says how a notebook shows it."""
    for name in results.KINDS:
        module, _, cls = name.partition(":")
        assert issubclass(getattr(import_module(f"actuator_opt.{module}"), cls), Displayed), name


def test_a_notebook_shows_the_page():
    """A result with a page shows it; a result that is text alone shows the text, escaped."""
    seen = Balance()
    seen.feed(ao.evaluate(KNEE)._repr_html_())
    assert not seen.open
    assert {"robot knee", "Requirements"} <= set(seen.words)
    installation = ao.doctor()
    assert installation._repr_html_().startswith("<")
    one_line(installation)


def test_the_report_is_written_as_asked(tmp_path):
    """PDF by default; HTML alone, or both, by `--format`; another word is refused at once."""
    for form, names in (
        ("pdf", {"knee_bonded.pdf", "knee_bonded.png"}),
        ("html", {"knee_bonded.html"}),
        ("both", {"knee_bonded.pdf", "knee_bonded.png", "knee_bonded.html"}),
    ):
        out = tmp_path / form
        assert run("report", KNEE, "--format", form, "--out", out).code in (0, 1)
        assert {path.name for path in out.iterdir()} == names
    done = run("report", KNEE, "--format", "docx", "--out", tmp_path / "none")
    assert done.code == 2
    assert "use one of pdf, html, both" in done.err
    assert not (tmp_path / "none" / "knee_bonded.html").exists()
