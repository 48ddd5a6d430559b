"""Units of columns whose header states none: `--units SI` or a file, for every record that is read.

And with --json every command's errors are said once.
"""

from __future__ import annotations

import json

import numpy as np
import pytest
from cli_runner import DESIGNS, KNEE, run

import actuator_opt as ao
from actuator_opt.identification import column_units, parse_column, parse_record
from actuator_opt.simulation.measured import parse_measured

BARE = "t,p1,x,F_L,T,Motor\n0,2e6,0.05,-70,313.15,7\n0.5,3e6,0.06,80,314.15,8\n"
"""SI numbers without a unit; T and Motor are asked for by nothing."""
RECORD = DESIGNS / "records" / "knee_bench.csv"


def refused(*given, **more):
    """The lines that refuse a text."""
    with pytest.raises(ao.InputError) as error:
        parse_record(*given, name="r.csv", **more)
    return [str(one) for one in error.value.diagnostics]


def test_si_is_m_s_pa_n_and_kelvin():
    """`SI` takes every column in SI units, temperatures in K; a note names the columns."""
    record = parse_record(BARE, units=column_units("SI"))
    np.testing.assert_array_equal(record.time, [0.0, 0.5])
    for name, values in {"p1": (2e6, 3e6), "x": (0.05, 0.06), "F_L": (-70, 80)}.items():
        np.testing.assert_array_equal(record[name], values)
    np.testing.assert_array_equal(record["T"], [313.15, 314.15])
    assert (
        'SI units used, as the header states no units: "t", "p1", "x", "F_L", "T"'
    ) in record.notes


def test_a_unit_in_the_header_wins_over_si():
    """`p1 [bar]` stays in bar under `SI`; a line of units below the header does too."""
    for head in ("t,p1 [bar],x\n", "t,p1,x\n,bar,\n"):
        record = parse_record(f"{head}0,20,0.05\n1,30,0.06\n", units=column_units("SI"))
        np.testing.assert_array_equal(record["p1"], [2e6, 3e6])
        np.testing.assert_array_equal(record["x"], [0.05, 0.06])


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("units.yaml", "# bench 7\nt: ms\nPressure A: bar\nx: mm\nspare: V\n"),
        ("units.csv", "# bench 7\nt,ms\nPressure A,bar\nx,mm\nspare,V\n"),
        ("units.csv", "t;ms\n\n Pressure A ; bar \nx;mm\n"),
    ],
)
def test_a_file_names_units_by_column(name, text, tmp_path):
    """YAML or CSV: the unit of each column; columns that the record lacks are no fault."""
    file = tmp_path / name
    file.write_text(text, encoding="utf-8")
    known = column_units(file)
    record = parse_record("t,Pressure A,x\n0,20,50\n500,30,60\n", units=known)
    np.testing.assert_allclose(record.time, [0.0, 0.5])
    np.testing.assert_allclose(record["p1"], [2e6, 3e6])
    np.testing.assert_allclose(record["x"], [0.05, 0.06])


@pytest.mark.parametrize(
    ("name", "text", "says"),
    [
        ("u.csv", "t,s\np1\n", ':2: "p1" is not a column with its unit; write the column'),
        ("u.csv", "t,s\nt,ms\n", ':2: column "t" is named twice; delete one line'),
        ("u.yaml", "t: s\np1:\n", ':2:1: column "p1" has no unit; write e.g. p1: bar'),
        ("u.yaml", "t: s\nt: ms\n", ":2"),
        ("u.yaml", "p1:\n  - bar\n", 'column "p1" has no unit'),
        ("u.yaml", "t: s\n- x", ":2"),
        ("u.csv", "t,\x1b[31m\n", ": column"),
    ],
)
def test_files_of_units_that_are_none(name, text, says, tmp_path):
    """A line in plain words with file, place and remedy."""
    file = tmp_path / name
    file.write_text(text, encoding="utf-8")
    with pytest.raises(ao.InputError) as error:
        parse_record("t,x\n0,1\n", units=column_units(file))
    assert says in str(error.value)
    assert "\x1b" not in str(error.value)


def test_a_contradiction_is_a_fault():
    """A file that states bar where the header states psi; one unit by two names is none."""
    text = "t [s],p1 [psi],T [°C]\n0,1,20\n1,2,20\n"
    (line,) = refused(text, units=column_units({"p1": "bar"}))
    assert 'column "p1" is in psi according to the header, not bar; correct one of them' in line
    same = parse_record(text, units=column_units({"p1": "psi", "T": "degC"}))
    assert same["T"][0] == pytest.approx(293.15)
    absolute = "t [s],p1 [bara]\n0,1\n1,2\n"
    assert "not bar" in refused(absolute, units=column_units({"p1": "bar"}))[0]


def test_an_unused_column_without_a_unit_is_no_fault():
    """T and v, and p2 of a plunger: left out and noted; a needed one is a fault as before."""
    record = parse_record("t [s],x [mm],T,v\n0,1,20,3\n1,2,20,4\n")
    assert set(record.channels) == {"x"}
    assert 'columns left out because they have no unit: "T", "v"' in record.notes
    (line,) = refused("t [s],x [mm],p1\n0,1,20\n1,2,20\n")
    assert 'column "p1" states no unit' in line
    assert "--units SI" in line
    few = parse_record("t [s],w [mm],F_L [N],p1\n0,1,2,3\n1,2,3,4\n", needed=("F_L", "w"))
    assert "p1" not in few


def test_records_of_a_simulation_take_them_too():
    """A measured record's and a scenario's columns; what both lack is said with its remedy."""
    rows = "".join(f"{0.1 * k:.1f},{1e5 * k},{k}\n" for k in range(12))
    measured = parse_measured(f"t,p1,T\n{rows}", units=column_units("SI"))
    np.testing.assert_allclose(measured.channels["pressure_a"][1], 1e5 * np.arange(12))
    text = "t,U\n0,1.5\n500,2.5\n"
    given = column_units({"t": "ms", "U": "V"})
    found = parse_column(text, "U", "voltage", name="in.csv", units=given)
    np.testing.assert_allclose(found, ([0.0, 0.5], [1.5, 2.5]))
    with pytest.raises(ao.InputError, match='"U" states no unit; name it with one'):
        parse_column(text, "U", "voltage", name="in.csv")
    with pytest.raises(ao.InputError, match='"U" is in mV, not V'):
        parse_column(text, "U [mV]", "voltage", name="in.csv", units=given)


@pytest.mark.long
def test_identify_with_si_is_identify_with_units(tmp_path):
    """One flag for all columns: bars times 1e5, millimetres over 1000, the same friction."""
    lines = [line for line in RECORD.read_text().splitlines() if not line.startswith("#")]
    scales = (1.0, 1e5, 1e5, 1e-3, 1.0)
    rows = [[float(x) for x in line.split(",")] for line in lines[1:6000]]
    heads = {"bar": lines[0], "bare": "t,p1,p2,x,F_L,Temp"}
    for name, head in heads.items():
        used = scales if name == "bare" else (1.0,) * 5
        cells = (",".join(repr(x * s) for x, s in zip(row, used, strict=True)) for row in rows)
        more = ",40" if name == "bare" else ""
        (tmp_path / name).write_text(head + "\n" + "\n".join(c + more for c in cells) + "\n")
    given = ("--design", KNEE, "--pressure-lag", "4 ms", "--json")
    found = run("identify", tmp_path / "bare", "--units", "SI", *given)
    stated = run("identify", tmp_path / "bar", *given)
    assert found.code == stated.code == 0, found.out
    assert found.json["friction"]["mean"] == pytest.approx(
        stated.json["friction"]["mean"], rel=1e-6
    )


def test_simulate_takes_units(tmp_path):
    """--units reaches --measured and recorded inputs; without a record it is refused."""
    scenario = DESIGNS / "scenarios" / "knee_step.yaml"
    result = run("simulate", scenario, "--units", "SI", "--json")
    assert result.code == 2
    assert "--units: only with a record" in result.errors[0]["message"]
    (tmp_path / "pull.csv").write_text("t,F\n0,2000\n1,2000\n")
    file = tmp_path / "a.yaml"
    file.write_text(
        f"name: a\ndesign: {DESIGNS / 'servo_knee.yaml'}\nduration: 0.05 s\n"
        "load:\n  force:\n    - {shape: record, file: pull.csv, column: F}\n"
    )
    result = run("simulate", file, "--json")
    assert result.code == 3
    assert "states no unit" in result.errors[0]["message"]
    result = run("simulate", file, "--units", "SI", "--json")
    assert result.code == 0, result.out
    assert result.json["signals"]["load_force"]["final"] == pytest.approx(2000)


FAULTY = [
    ("identify", "nofile.csv", "--design", KNEE),
    ("identify", RECORD, "--design", "nofile.yaml"),
    ("identify", RECORD, "--design", KNEE, "--units", "nofile.yaml"),
    ("identify", RECORD, "--design", KNEE, "--column", "p1"),
    ("identify", RECORD),
    ("calibrate", "nofile.csv", "--design", KNEE),
    ("simulate", "nofile.yaml"),
    ("simulate", DESIGNS / "scenarios" / "knee_step.yaml", "--measured", "nofile.csv"),
    ("check", "nofile.yaml"),
    *((verb, "nofile.yaml") for verb in ("evaluate", "optimise", "sensitivity", "uncertainty")),
    *((verb, "nofile.yaml") for verb in ("report", "explore", "rerun", "compare")),
    ("sweep", KNEE, "--vary", "nothing=1"),
    ("pareto", KNEE, "--objective", "nothing:min"),
    ("seal", KNEE, "--seal", "nothing"),
    ("export", KNEE, "--format", "nothing"),
    ("materials", "show", "nothing"),
    ("runs", "show", "nothing"),
    ("evaluate", KNEE, "--nothing"),
    ("nothing",),
]


@pytest.mark.parametrize("words", FAULTY, ids=lambda words: " ".join(map(str, words))[-40:])
def test_with_json_errors_are_said_once(words, tmp_path):
    """Under --json every command says its errors in one object on stdout, nothing on stderr."""
    result = run(*words, "--json", environment={"ACTUATOR_OPT_RUNS": str(tmp_path)})
    assert result.code in (2, 3)
    assert result.err == ""
    assert json.loads(result.out)["errors"]
