"""The plain report for machines without the typst wheel."""

import importlib.util
import re

import pytest
import report_fixture as fixture

from actuator_opt.pages import read_attachment
from actuator_opt.rendering import attachments as embed, paper_plain as fallback


@pytest.fixture
def no_typst(monkeypatch):
    """A machine without the typst wheel."""
    real = importlib.util.find_spec
    monkeypatch.setattr(
        importlib.util, "find_spec", lambda name: None if name == "typst" else real(name)
    )


@pytest.mark.long
def test_plain_report_says_so_and_carries_its_input(tmp_path, no_typst):
    """PDF and PNG exist, the input is inside, and the sheet says why it is plain."""
    given = {"stem": "r", "source_text": "a: 1\n", "source_name": "a.yaml", "command": "c"}
    files = fixture.write_report(fixture.build_infeasible(), folder=tmp_path, **given)
    assert files[0].pages == len(files) - 1
    assert read_attachment(files[0].path).source == "a: 1\n"
    content = files[0].path.read_bytes()
    assert not re.search(rb"/CreationDate", content)
    pypdf = pytest.importorskip("pypdf")
    reader = pypdf.PdfReader(files[0].path)
    assert reader.attachments["a.yaml"] == [b"a: 1\n"]
    assert "typst package is not installed" in reader.pages[0].extract_text()


def test_wrapped_lines_fit():
    """No line is wider than its room and no letter is lost."""
    words = "one two " + "x" * 200 + " three"
    lines = fallback.wrap(words, 30.0, 7.0)
    assert "".join(lines).replace(" ", "") == words.replace(" ", "")
    assert all(fallback.text_width(line, 7.0) <= 30.0 for line in lines)


def test_embedding_keeps_the_original_bytes():
    """An incremental update only appends, and what went in comes out."""
    pdf = (
        b"%PDF-1.4\n1 0 obj\n<< /Type /Catalog /Pages 2 0 R >>\nendobj\n"
        b"2 0 obj\n<< /Type /Pages /Kids [] /Count 0 >>\nendobj\n"
        b"xref\n0 3\ntrailer\n<< /Size 3 /Root 1 0 R >>\nstartxref\n109\n%%EOF\n"
    )
    files = [("a (b).yaml", "application/yaml", b"x: 1"), ("r", "application/json", b"{}")]
    out = embed.embed(pdf, files)
    assert out.startswith(pdf)
    inside = {"application/yaml": b"x: 1", "application/json": b"{}"}
    assert embed.extract(out, list(inside)) == inside
    assert embed.embed(pdf, files) == out
