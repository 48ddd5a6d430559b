"""`identify` and `calibrate` at the terminal: the contract's JSON, files, every wrong record."""

from __future__ import annotations

import json

import numpy as np
import pytest
from cli_runner import DESIGNS, KNEE, run

import actuator_opt as ao

RECORD = DESIGNS / "records" / "knee_bench.csv"
TEXT = RECORD.read_text(encoding="utf-8")
KEYS = {
    "record", "design", "version", "friction", "mu", "stribeck", "lugre", "damping", "fits",
    "pressure_lag", "filter", "channels", "notes",
}  # fmt: skip


def identify(*arguments, record=RECORD, code=0):
    """What `identify` of the knee says."""
    result = run("identify", str(record), "--design", str(KNEE), *arguments)
    assert result.code == code, (result.out[:1000], result.err)
    return result


def refused(text, tmp_path, *arguments, command="identify"):
    """The one line that refuses a record."""
    file = tmp_path / "record.csv"
    file.write_text(text, encoding="utf-8")
    result = run(command, str(file), "--design", str(KNEE), *arguments)
    assert result.code == 3, (result.out[:500], result.err)
    assert result.out == ""
    (line,) = result.err.strip().splitlines()
    assert line.startswith(str(file)) or "record.csv" in line
    return line


def table(every=1):
    """Header and rows of the shipped record."""
    lines = [line for line in TEXT.splitlines() if not line.startswith("#")]
    return lines[0].split(","), [row.split(",") for row in lines[1::every]]


def written(header, rows):
    """A record of rows."""
    return "\n".join([",".join(header), *(",".join(row) for row in rows)]) + "\n"


@pytest.fixture(scope="module")
def series(tmp_path_factory):
    """Friction over time of the shipped record as CSV, and the JSON beside it."""
    file = tmp_path_factory.mktemp("series") / "series.csv"
    return file, identify("--json", "--csv", str(file)).json


@pytest.fixture(scope="module")
def found(series):
    """The JSON of the shipped record, without its files."""
    return {key: value for key, value in series[1].items() if key != "files"}


def test_json_of_the_contract(found):
    """Every key the contract names, SI, no NaN; bounds hold their values."""
    assert set(found) >= KEYS
    assert set(found["friction"]) >= {"mean", "max", "pressure_loss"}
    assert set(found["mu"]) >= {"value", "lower", "upper", "contact_pressure"}
    for model in ("stribeck", "lugre"):
        for one in found[model].values():
            assert set(one) >= {"value", "lower", "upper", "identifiable"}
            assert one["lower"] <= one["value"] <= one["upper"]
    for one in found["damping"]:
        assert set(one) >= {"velocity", "pressure", "value"}
    assert set(found["fits"]) == {"power_law", "double_exponential"}
    json.dumps(found, allow_nan=False)


def test_the_library_says_the_same(found):
    """`identify` in a script is `identify` at the terminal."""
    again = ao.identify(RECORD, design=KNEE).to_dict()
    assert {k: v for k, v in again.items() if k != "record"} == {
        k: v for k, v in found.items() if k != "record"
    }


def test_series_are_written_and_read_back(series, found):
    """The CSV of friction over time is itself a record: its channels read back."""
    file, _ = series
    again = ao.read_record(file)
    assert set(again.channels) >= {"x", "v", "p1", "p2"}
    heads = file.read_text(encoding="utf-8").splitlines()[0].split(",")
    friction = np.loadtxt(file, delimiter=",", skiprows=1, usecols=heads.index("friction [N]"))
    assert np.max(np.abs(friction)) <= 1.05 * found["friction"]["max"]
    assert "k_eq [kN/mm]" in heads


def test_report_and_text(tmp_path):
    """The page is written where asked; the terminal shows the table, the files go to stderr."""
    pytest.importorskip("typst")
    result = identify("--report", "--out", str(tmp_path))
    assert {p.name for p in tmp_path.iterdir()} == {
        "knee_bench_identification.pdf", "knee_bench_identification.png",
    }  # fmt: skip
    assert "Coulomb" in result.out
    assert result.err.count("wrote ") == 2


def test_columns_may_be_named(tmp_path, found):
    """Foreign headers are named with --column, with a unit where the file has none."""
    _, rows = table()
    foreign = ["clock", "Channel 3", "Channel 4", "wire", "cell"]
    file = tmp_path / "foreign.csv"
    file.write_text(written(foreign, rows), encoding="utf-8")
    named = [
        "t=clock [s]",
        "p1=Channel 3 [bar]",
        "p2=Channel 4 [bar]",
        "x=wire [mm]",
        "F_L=cell [N]",
    ]
    arguments = [word for one in named for word in ("--column", one)]
    again = identify(*arguments, "--json", record=file).json
    assert again["stribeck"] == found["stribeck"]


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (lambda h: [*h[:1], "pressure one", *h[2:]], ("no column p1", "--column")),
        (lambda h: [*h[:2], "p2", *h[3:]], ("states no unit", "bar")),
        (lambda h: [*h[:2], "p2 [mm]", *h[3:]], ("p2", "mm is a length")),
        (lambda h: [*h[:2], "p1 [bar]", *h[3:]], ("both name the channel p1", "rename")),
    ],
)
def test_wrong_headers_are_one_line(tmp_path, change, said):
    """An unknown, unitless, wrong or doubled column."""
    header, rows = table(20)
    line = refused(written(change(header), rows), tmp_path)
    for words in said:
        assert words in line


def test_reversed_pressures_are_detected_and_said(tmp_path):
    """Swapped pressure channels: which, and what to do."""
    header, rows = table()
    swapped = [header[0], "p2 [bar]", "p1 [bar]", *header[3:]]
    line = refused(written(swapped, rows), tmp_path)
    assert "p1 and p2 seem swapped" in line
    assert "swap p1 and p2" in line


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "empty"),
        ("t [s],p1 [bar],p2 [bar],x [mm],F_L [N]\n", "no samples"),
        ("t [s],p1 [bar],p2 [bar],x [mm],F_L [N]\n0,1,1,1,1\n0.01,1,1,1,1\n", "too short"),
        ("0,1,2,3,4\n1,2,3,4,5\n", "no header"),
        (
            "t [s],p1 [bar],p2 [bar],x [mm],F_L [N]\n0,1,x,1,1\n",
            '"x" in column "p2" is not a number',
        ),
    ],
)
def test_poor_records_are_one_line(tmp_path, text, said):
    """Empty, too short, without header, with words for numbers."""
    assert said in refused(text, tmp_path)


def test_a_missing_force_is_asked_for(tmp_path):
    """No load cell: the record is refused until the load is stated."""
    header, rows = table()
    without = written(header[:4], [row[:4] for row in rows])
    line = refused(without, tmp_path)
    assert "--load-force" in line


def test_a_free_rod_needs_no_load_cell(tmp_path):
    """With --load-force the no-load part of the record gives its friction."""
    header, rows = table()
    free = [row[:4] for row in rows if float(row[0]) < 14.5]
    file = tmp_path / "free.csv"
    file.write_text(written(header[:4], free), encoding="utf-8")
    data = identify("--load-force", "0 N", "--json", record=file).json
    assert data["friction"]["mean"] == pytest.approx(40.0, rel=0.25)


def test_constant_velocity_gives_no_stribeck_curve(tmp_path):
    """One speed: friction and its coefficient, and one line that says what a curve needs."""
    header, _ = table()
    time = np.arange(0, 6, 0.002)
    rows = [[f"{t:.3f}", "12.0", "5.0", f"{20 + 10 * t:.3f}", "0"] for t in time]
    file = tmp_path / "constant.csv"
    file.write_text(written(header, rows), encoding="utf-8")
    data = identify("--json", record=file).json
    assert data["stribeck"] is None
    assert "one speed, 10 mm/s" in data["stribeck_why"]
    assert data["mu"]["value"] > 0


@pytest.mark.parametrize(
    ("arguments", "code", "said"),
    [
        (["--cutoff", "30"], 2, "--cutoff"),
        (["--cutoff", "30 mm"], 2, "--cutoff"),
        (["--cutoff", "400 Hz"], 3, "too few for a cut-off"),
        (["--column", "p1"], 2, "CHANNEL=NAME"),
        (["--column", "p9=a"], 3, "not a channel"),
        (["--mass", "-1 kg"], 2, "--mass"),
        (["--order", "0"], 2, "order"),
        (["--span", "0 mm"], 2, "--span"),
        (["--bootstrap", "-3"], 2, "bootstrap"),
    ],
)
def test_wrong_options_are_one_line(arguments, code, said):
    """Malformed, without unit or out of range: one line; 2 for an option, 3 for the record."""
    result = run("identify", str(RECORD), "--design", str(KNEE), *arguments)
    assert result.code == code
    assert said in result.err
    assert len(result.err.strip().splitlines()) == 1


def test_a_record_that_is_not_there():
    """A near name is suggested."""
    result = run("identify", str(RECORD.with_name("knee_bensh.csv")), "--design", str(KNEE))
    assert result.code == 3
    assert "no such file" in result.err
    assert "knee_bench.csv" in result.err


@pytest.fixture(scope="module")
def calibrated(tmp_path_factory):
    """JSON and design of `calibrate` of the shipped record."""
    file = tmp_path_factory.mktemp("calibrated") / "knee_bonded.yaml"
    result = run("calibrate", str(RECORD), "--design", str(KNEE), "--write", str(file), "--json")
    assert result.code == 1, result.err  # the start of the knee misses requirements
    return result.json, file


@pytest.mark.long
def test_calibrate_says_what_moved(calibrated):
    """Values with bounds, requirements before and after, the optimum before and after."""
    data, _ = calibrated
    assert data["moved"] == "friction_running"
    values = data["learned"]["friction_coefficient"]["values"]
    for one in values.values():
        assert one["lower"] < one["value"] < one["upper"] < one["before"]
    best = data["optimum"]
    for ends in best["objective"].values():  # friction is below its limit at the best design
        assert ends["after"] == pytest.approx(ends["before"], rel=1e-6)
    assert best["active"]["after"] == best["active"]["before"]
    assert not any("friction_running" in one for one in best["active"]["before"])
    json.dumps(data, allow_nan=False)


@pytest.mark.long
def test_calibrate_says_which_limit_the_best_design_newly_stands_on():
    """At 250 N the stated friction (248 N at the best design) is met for nothing; measured, not."""
    limited = ao.read(KNEE, set={"requirements.friction_running.max": "250 N"})
    best = ao.calibrate(RECORD, design=limited).to_dict()["optimum"]
    mass = best["objective"]["mass"]
    assert mass["after"] > mass["before"] * (1 + 1e-4)
    assert not any("friction_running" in one for one in best["active"]["before"])
    assert any("friction_running" in one for one in best["active"]["after"])


def test_the_written_design_evaluates_to_the_values_said(calibrated):
    """The file reads without a fault, keeps its comments, and has the friction that was said."""
    data, file = calibrated
    assert ao.check(file) == []
    assert "# " in file.read_text(encoding="utf-8")
    row = next(r for r in data["requirements"] if r["name"] == "friction_running")
    metric = ao.evaluate(file).metrics["friction_running"].value
    assert metric == pytest.approx(row["after"], rel=1e-12)
    measured = ao.read(file).design.measured
    assert {one.record for one in measured.values()} == {"knee_bench.csv"}
    assert len(measured) == 8


def test_the_bounds_of_a_requirement_are_those_of_its_causes(calibrated):
    """Changes of friction at the bounds of factor and viscous part, added as squares, by hand."""
    data, file = calibrated
    row = next(r for r in data["requirements"] if r["name"] == "friction_running")
    for end in ("lower", "upper"):
        changes = []
        for name in ("friction_coefficient", "viscous_friction"):
            values = data["learned"][name]["values"]
            moved = ao.read(file, set={path: one[end] for path, one in values.items()})
            changes.append(ao.evaluate(moved).metrics["friction_running"].value - row["after"])
        assert abs(row[end] - row["after"]) == pytest.approx(np.hypot(*changes), rel=1e-3)


@pytest.mark.long
def test_calibrate_without_search_and_its_page(tmp_path):
    """--no-optimise leaves the optima out; the report is one page with the new design inside."""
    pypdf = pytest.importorskip("pypdf")
    pytest.importorskip("typst")
    result = run("calibrate", str(RECORD), "--design", str(KNEE), "--no-optimise", "--report",
                 "--out", str(tmp_path))  # fmt: skip
    assert result.code == 1
    assert "friction_running" in result.out
    page = pypdf.PdfReader(tmp_path / "knee_bench_calibration.pdf")
    assert len(page.pages) == 1
    names = list(page.attachments)
    design = next(n for n in names if n.endswith(".yaml"))
    assert "measured:" in page.attachments[design][0].decode("utf-8")


def test_a_folder_that_cannot_be_written_is_said_before_the_work(tmp_path):
    """The place to write is tried first."""
    target = tmp_path / "none" / "knee_bonded.yaml"
    result = run("calibrate", str(RECORD), "--design", str(KNEE), "--write", str(target))
    assert result.code == 3
    assert "its folder does not exist" in result.err


def test_calibrate_of_a_film_is_refused():
    """Friction by the oil film has no coefficient: one line at its PATH."""
    result = run("calibrate", str(RECORD), "--design", str(KNEE), "--set",
                 "seals.rod.friction=film", "--no-optimise")  # fmt: skip
    assert result.code == 3
    assert "seals.rod.friction" in result.err
    assert "oil film" in result.err


def test_a_bending_record_gives_a_modulus(tmp_path):
    """A rod of 13/6 mm on 300 mm: E = k L^3/(48 I), and shear taken off."""
    inertia = np.pi / 64 * (0.013**4 - 0.006**4)
    modulus, span = 205e9, 0.3
    force = np.linspace(0, 2000, 200)
    bend = force * span**3 / (48 * modulus * inertia)
    rows = [[f"{t:.2f}", f"{f:.4f}", f"{1e3 * w:.6f}"]
            for t, f, w in zip(0.1 * np.arange(200), force, bend, strict=True)]  # fmt: skip
    file = tmp_path / "bend.csv"
    file.write_text(written(["t [s]", "F_L [N]", "w [mm]"], rows), encoding="utf-8")
    data = identify("--span", "300 mm", "--json", record=file).json
    assert data["modulus_as_published"]["value"] == pytest.approx(modulus, rel=1e-3)
    assert data["modulus"]["value"] > data["modulus_as_published"]["value"]
    shown = identify("--span", "300 mm", record=file)
    assert "GPa" in shown.out
