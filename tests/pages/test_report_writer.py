"""Files of a report: whole or none, the same bytes again, the input inside."""

import io
import os
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import pytest
import report_fixture as fixture
from full_disk import fill

from actuator_opt.base.errors import InputError
from actuator_opt.pages import read_attachment
from actuator_opt.rendering import paper
from actuator_opt.rendering.blocks import text_table

TESTS = Path(__file__).parents[1]
NAME = r"a # $ \ * _ @ < > [x](y) `z` {w} ~ // /* é ü θ ≥ "
SCRIPT = """
import sys, pathlib
import report_fixture as fixture
for file in fixture.write_report(
        fixture.build_optimisation(), folder=pathlib.Path(sys.argv[1]), stem="r", command="c",
        source_text=fixture.SOURCE, source_name="knee_bonded.yaml", date=sys.argv[2] or None):
    print(file.path.name, file.sha256)
"""


def write(subject, folder, **changes):
    """Write a report with the fixture's source."""
    given = {
        "stem": "r",
        "source_text": fixture.SOURCE,
        "source_name": "designs/knee_bonded.yaml",
        "command": "actuator-opt optimise designs/knee_bonded.yaml",
        "date": None,
    }
    return fixture.write_report(subject, folder=folder, **(given | changes))


@pytest.mark.parametrize("date", ["", pytest.param("2026-02-03", marks=pytest.mark.long)])
@pytest.mark.long
def test_same_input_same_bytes_in_any_process(tmp_path, date):
    """Two processes with different hash seeds, folders and clocks write equal files."""
    printed = []
    for seed in ("1", "2"):
        environment = os.environ | {
            "PYTHONHASHSEED": seed,
            "PYTHONPATH": os.pathsep.join([str(TESTS / "cases"), str(TESTS.parent)]),
            "TZ": "Pacific/Auckland" if seed == "2" else "UTC",
        }
        command = [sys.executable, "-c", SCRIPT, str(tmp_path / seed), date]
        done = subprocess.run(command, env=environment, capture_output=True, text=True, check=True)
        printed.append(done.stdout)
    assert printed[0] == printed[1]
    assert printed[0].splitlines()[0].startswith("r.pdf ")


def test_a_page_compiled_again_has_the_same_bytes(tmp_path, monkeypatch):
    """Other tests compile equal pages only once."""
    monkeypatch.setattr(paper, "sheets", paper.sheets.__wrapped__)
    first, second = (write(fixture.build_evaluation(), tmp_path / name) for name in "ab")
    assert [file.sha256 for file in first] == [file.sha256 for file in second]


def test_files_and_pages(tmp_path):
    """PDF first with its page count, one PNG per sheet, hashes as written, nothing else."""
    files = write(fixture.build_optimisation(), tmp_path / "new" / "folder")
    assert files[0].path.name == "r.pdf"
    assert files[0].pages == len(files) - 1
    assert [f.path.name for f in files[1:3]] == ["r.png", "r-page-2.png"]
    assert {f.path for f in files} == set((tmp_path / "new" / "folder").iterdir())
    assert files[0].to_dict()["pages"] == files[0].pages


def test_report_carries_its_input(tmp_path):
    """The attached input and command come back to the letter, also from odd names."""
    source = "name: é 中文 \u202e\n# \x07 $ \\ *\n"
    files = write(
        fixture.build_evaluation(),
        tmp_path,
        source_text=source,
        source_name="a b#(é.yaml",
        command="actuator-opt evaluate 'a b'",
    )
    carried = read_attachment(files[0].path)
    assert carried.source == source
    assert carried.run["command"] == "actuator-opt evaluate 'a b'"
    assert carried.run["source_name"] == "a b#(é.yaml"


def test_an_independent_reader_finds_the_attachment(tmp_path):
    """A PDF library that is not ours extracts the input and reads the texts."""
    pypdf = pytest.importorskip("pypdf")
    files = write(fixture.build_optimisation(fixture.build_evaluation(NAME)), tmp_path)
    reader = pypdf.PdfReader(files[0].path)
    assert reader.attachments["knee_bonded.yaml"] == [fixture.SOURCE.encode()]
    assert len(reader.pages) == files[0].pages
    first = " ".join(reader.pages[0].extract_text().split())
    assert NAME.strip() in first
    assert "SCALE 1:2" in first


def test_no_input_inside_is_said(tmp_path):
    """A foreign PDF gives one line with its name."""
    path = tmp_path / "x.pdf"
    path.write_bytes(b"%PDF-1.7\n%%EOF\n")
    with pytest.raises(InputError, match=r"x\.pdf.*has no input"):
        read_attachment(path)
    with pytest.raises(InputError, match="no such file"):
        read_attachment(tmp_path / "missing.pdf")


def test_a_folder_that_cannot_be_written_leaves_nothing(tmp_path):
    """A file where the folder should be: one line, exit 3, no partial file."""
    (tmp_path / "out").write_text("a file")
    with pytest.raises(InputError, match="cannot write the report") as caught:
        write(fixture.build_evaluation(), tmp_path / "out")
    assert len(caught.value.diagnostics) == 1
    assert sorted(p.name for p in tmp_path.iterdir()) == ["out"]


def test_a_disk_that_fails_midway_leaves_nothing(tmp_path, monkeypatch):
    """A write error in the second file removes what was written aside, keeps the old report."""
    (tmp_path / "r.pdf").write_text("old")
    opened = fill(monkeypatch, after=1)
    with pytest.raises(InputError, match="No space left"):
        write(fixture.build_evaluation(), tmp_path)
    assert len(opened) == 2
    assert [p.name for p in tmp_path.iterdir()] == ["r.pdf"]
    assert (tmp_path / "r.pdf").read_text() == "old"


def test_pages_of_an_older_longer_report_go(tmp_path):
    """Sheets beyond the new count do not stay behind; other files do."""
    for name in ("r-page-4.png", "r-page-5.png", "r-page-9.png", "r-2.png"):
        (tmp_path / name).write_text("old")
    write(fixture.build_evaluation(), tmp_path)
    left = {p.name for p in tmp_path.iterdir()}
    assert "r-2.png" in left
    assert "r-page-5.png" not in left


def test_a_ruler_on_the_print_reads_the_stroke(tmp_path, monkeypatch):
    """On the 150 dpi PNG of an A4 sheet the 110 mm oil column at 1:2 is 55 mm wide."""
    monkeypatch.setattr(paper, "PIXELS_PER_INCH", 150.0)
    image_module = pytest.importorskip("PIL.Image")
    files = write(fixture.build_evaluation(), tmp_path)
    image = image_module.open(io.BytesIO(files[1].path.read_bytes())).convert("RGB")
    pixels_per_mm = image.width / 210.0
    assert image.size == (1240, 1754)
    oil = (0xDC, 0xEC, 0xF7)
    widths = []
    for y in range(image.height // 8, image.height // 2):
        row = [x for x in range(image.width) if image.getpixel((x, y)) == oil]
        if len(row) > 100:
            widths.append((row[-1] - row[0] + 1) / pixels_per_mm)
    assert max(widths) == pytest.approx(55.0, abs=0.35)


def test_absurd_content_still_prints(tmp_path):
    """40 requirements, 16 variables, endless words, missing values, empty tables: a whole PDF."""
    rows = tuple(
        replace(
            fixture.requirements()[k % 11],
            name="x" * (k * 7),
            case="case " * 9,
            **({"value": None, "margin": None, "met": False} if k % 7 == 3 else {}),
        )
        for k in range(40)
    )
    evaluation = fixture.build_evaluation(
        NAME + "nobreak" * 40,
        requirements=rows,
        warnings=("#panic() " * 60,),
        models=(),
        unverified=(),
        mass_parts={"barrel": 0.0},
        mass_leaves_out=("ports and fittings",),
        outlines=fixture.outlines(walls=(1e-4,) * 30)[0],
    )
    base = fixture.build_optimisation(evaluation)
    variables = tuple(replace(base.variables[k % 8], path="p" * 90) for k in range(16))
    subject = replace(base, variables=variables, sentence="*not bold* $x$ #panic() <label>")
    files = write(
        subject,
        tmp_path,
        source_text="# " + "y" * 900 + "\n\ttab\n" * 3,
        command="c " * 900,
        date="2026-02-03",
        extra_tables=[text_table("#t", ["a"], [])],
    )
    assert files[0].path.read_bytes().startswith(b"%PDF-1.7")
    assert files[0].pages < 12


def test_an_infeasible_card_prints(tmp_path):
    """The report of a design that cannot be is a report too."""
    assert write(fixture.build_infeasible(), tmp_path)[0].pages >= 2
