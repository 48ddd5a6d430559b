"""The flow curve of a valve as CSV: what is read, what is refused in one line, and what is kept."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest
from cli_runner import run
from hypothesis import given, settings, strategies as st

import actuator_opt as ao
from actuator_opt.base.errors import InputError
from actuator_opt.design.data_file import DataFile, portable
from actuator_opt.design.flow_curve import MOST_ROWS, flow_table
from actuator_opt.design.writer import to_yaml
from actuator_opt.evaluation.build import spec_hash
from actuator_opt.models.metering_spool import spool_flows
from actuator_opt.pages import valve as page
from actuator_opt.studies.plant import plant

KNEE = Path("designs/servo_knee.yaml")
LITRE = 1 / 60000
GOOD = "signal [%],q [l/min]\n0,0\n5,0\n10,1\n50,9\n100,20\n"
EDGES = (
    "signal [V],q_pa [l/min],q_pb [l/min],q_at [l/min],q_bt [l/min]\n"
    "-10,0,10,18,0\n0,0.1,0.1,0.2,0.2\n10,20,0,0,9\n"
)


def block(*lines, curve="curve.csv"):
    """Lines of a valve with a flow curve."""
    return [f"flow_curve: {curve}", "rated_drop: 35 bar", "natural_frequency: 120 Hz", *lines]


def design(tmp_path, table=GOOD, lines=None, *, name="curve.csv"):
    """The servo knee with a valve whose flow curve is in a file beside it."""
    if isinstance(table, str):
        (tmp_path / name).write_text(table, "utf-8")
    elif table is not None:
        (tmp_path / name).write_bytes(table)
    text = "valve:\n" + "".join(f"  {line}\n" for line in (block() if lines is None else lines))
    changed = re.sub(r"(?m)^valve:.*\n(?:  .*\n)+", lambda _: text, KNEE.read_text("utf-8"))
    path = tmp_path / "design.yaml"
    path.write_text(changed, "utf-8")
    return ao.read(path)


def flows(made, signal):
    """Flows P-A, P-B, A-T, B-T at 35 bar per edge [l/min]."""
    spool = plant(made.subject()).valve.metering
    found = spool_flows(
        spool=spool, signal=signal, supply_pressure=70e5, return_pressure=0.0, pressure_a=35e5,
        pressure_b=35e5,
    )  # fmt: skip
    return np.array(found) / LITRE


def test_flows_are_those_of_the_table(tmp_path):
    """One column: the opening edges pass it in both directions, the others its flow at zero."""
    made = design(tmp_path)
    np.testing.assert_allclose(flows(made, 5.0), [9, 0, 0, 9], rtol=1e-5, atol=1e-9)
    np.testing.assert_allclose(flows(made, -10.0), [0, 20, 20, 0], rtol=1e-5, atol=1e-9)
    np.testing.assert_allclose(flows(made, 0.4), 0.0, atol=1e-12)
    assert 0.05 < plant(made.subject()).valve.start(1.0) / 10.0 < 0.1
    notes = [text for text in ao.evaluate(made).warnings if "dead band" in text]
    assert len(notes) == 1


def test_flows_of_single_edges(tmp_path):
    """Four columns: each edge has its own, over the whole signal; leakage is that at the centre."""
    made = design(tmp_path, EDGES)
    np.testing.assert_allclose(flows(made, 10.0), [20, 0, 0, 9], rtol=1e-5, atol=1e-9)
    np.testing.assert_allclose(flows(made, -10.0), [0, 10, 18, 0], rtol=1e-5, atol=1e-9)
    np.testing.assert_allclose(flows(made, 0.0), [0.1, 0.1, 0.2, 0.2], rtol=1e-5)
    notes = [text for text in ao.evaluate(made).warnings if "four edges differ" in text]
    assert len(notes) == 1


def test_both_signs_of_one_flow(tmp_path):
    """Rows at negative signals state the other direction, with flows of either sign."""
    for sign in (1, -1):
        table = f"signal [%],q [l/min]\n-100,{sign * 15}\n-10,{sign}\n0,0\n10,2\n100,20\n"
        made = design(tmp_path, table)
        np.testing.assert_allclose(flows(made, 10.0), [20, 0, 0, 20], rtol=1e-5, atol=1e-9)
        np.testing.assert_allclose(flows(made, -1.0), [0, 1, 1, 0], rtol=1e-5, atol=1e-9)


def test_viscosity_lowers_the_flow(tmp_path):
    """K falls with the eighth root of the viscosity, as that of a rated flow."""
    cold = design(tmp_path, lines=block("rated_viscosity: 10 mm^2/s"))
    viscosity = plant(cold.subject()).oil.kinematic_viscosity
    expected = 20 * (10e-6 / viscosity) ** 0.125
    assert flows(cold, 10.0)[0] == pytest.approx(expected, rel=1e-5)


@pytest.mark.parametrize(
    "table",
    [
        "# measured\nsignal [%];q [l/min]\n0;0,0\n5;0\n10;1,0\n50;9\n100;20\n",
        "u [V]\tq [l/min]\r\n0\t0\r\n0.5\t0\r\n1\t1\r\n5\t9\r\n10\t20\r\n",
        "signal,q\n%,ml/min\n0,0\n5,0\n10,1000\n50,9000\n100,20000\n",
        "\ufeffCommand [%],Flow [m^3/s]\n0,0\n5,0\n10,1.6666666666666667e-5\n"
        "50,1.5e-4\n100,3.3333333333333335e-4\n",
    ],
)
def test_dialects(table, tmp_path):
    """Separators, decimal commas, units in a line of their own, comments, byte order mark."""
    np.testing.assert_allclose(flows(design(tmp_path, table), 5.0), [9, 0, 0, 9], rtol=1e-5)


REFUSED = {
    "no file": (None, "curve.csv: no such file"),
    "empty": ("", "curve.csv: the flow curve is empty"),
    "workbook": (b"PK\x03\x04" + b"\0" * 40, "curve.csv: the file is a workbook"),
    "binary": (b"signal [%],q [l/min]\n0,\x00\n", "curve.csv, line 2: not text: byte 0x00"),
    "large": ("signal [%],q [l/min]\n" + "0,0\n" * 40_000, "the file is larger than 100 kB"),
    "rows": (
        "signal [%],q [l/min]\n" + "".join(f"{k / 3},{k}\n" for k in range(301)),
        f"curve.csv: 301 rows; give 2 to {MOST_ROWS} rows",
    ),
    "one row": ("signal [%],q [l/min]\n0,0\n", "curve.csv: 1 rows"),
    "no heading": ("0,0\n100,20\n", "curve.csv, line 1: no header"),
    "no signal": ("x [%],q [l/min]\n0,0\n100,1\n", "curve.csv, line 1: no column of the signal"),
    "no flow": ("signal [%],p [bar]\n0,0\n100,1\n", "curve.csv, line 1: no column of the flow"),
    "two flows": (
        "signal [%],q [l/min],flow [l/min]\n0,0,0\n100,1,1\n", 'line 1: two columns "q"',
    ),
    "mixed": (
        "signal [%],q [l/min],q_pa [l/min]\n0,0,0\n100,1,1\n",
        "line 1: flows of all and of single edges",
    ),
    "an edge less": (
        "signal [%],q_pa [l/min],q_pb [l/min],q_at [l/min]\n-100,0,1,1\n100,1,0,0\n",
        "curve.csv, line 1: no column q_bt; give q_pa, q_pb, q_at and q_bt",
    ),
    "no unit": (
        "signal [%],q\n0,0\n100,1\n",
        'curve.csv, line 1, column "q": the heading states no unit',
    ),
    "wrong unit": (
        "signal [%],q [bar]\n0,0\n100,1\n",
        'curve.csv, line 1, column "q [bar]": the unit bar does not fit',
    ),
    "milliampere": (
        "signal [mA],q [l/min]\n0,0\n100,1\n", 'column "signal [mA]": the unit mA does not fit',
    ),
    "text": (
        "signal [%],q [l/min]\n0,0\n50,many\n100,1\n",
        'curve.csv, line 3: "many" in column "q" is not a number',
    ),
    "empty cell": (
        "signal [%],q [l/min]\n0,0\n50,\n100,1\n",
        'curve.csv, line 3, column "q [l/min]": no finite number; write one, or remove the row',
    ),
    "nan": (
        "signal [%],q [l/min]\n0,0\nnan,3\n100,1\n",
        'curve.csv, line 3, column "signal [%]": no finite number',
    ),
    "infinite": (
        "signal [%],q [l/min]\n0,0\n50,1e999\n100,1\n", 'line 3, column "q [l/min]": no finite',
    ),
    "huge": (
        "signal [%],q [l/min]\n0,0\n100,1e12\n", 'line 3, column "q [l/min]": 1e+12 l/min: outside',
    ),
    "long line": (
        "signal [%],q [l/min]\n0,0\n50,1,2,3\n100,1\n", "curve.csv, line 3",
    ),
    "falling signal": (
        "signal [%],q [l/min]\n0,0\n50,1\n40,2\n100,3\n",
        'curve.csv, line 4, column "signal [%]": the signal does not rise; sort the rows',
    ),
    "same signal": (
        "signal [%],q [l/min]\n0,0\n50,1\n50,2\n100,3\n", "line 4, column",
    ),
    "falling flow": (
        "signal [%],q [l/min]\n0,0\n50,5\n60,4.5\n100,9\n",
        'curve.csv, line 4, column "q [l/min]": 4.5 l/min is less than at a smaller opening '
        "(5 l/min); smooth the curve: write at least 5 l/min",
    ),
    "falling edge": (
        EDGES.replace("0,0.1,0.1,0.2,0.2", "0,0.1,0.1,19,0.2"),
        'column "q_at [l/min]": 18 l/min is less than at a smaller opening (19 l/min)',
    ),
    "negative flow": (
        "signal [%],q [l/min]\n0,-1\n100,9\n",
        'curve.csv, line 2, column "q [l/min]": a negative flow; write its size',
    ),
    "two signs": (
        "signal [%],q [l/min]\n-100,-9\n-50,4\n0,0\n100,9\n", "line 3, column",
    ),
    "no zero": (
        "signal [%],q [l/min]\n1,0\n100,9\n", "curve.csv: no row at signal 0; add it",
    ),
    "never opens": (
        "signal [%],q [l/min]\n0,1\n100,1\n", 'line 3, column "q [l/min]": the flow never rises',
    ),
    "ends early": (
        "signal [V],q [l/min]\n0,0\n8,9\n",
        "curve.csv: the signal ends at 8 V, not at the full signal (10 V); give rows up to 10 V, "
        "or set valve.signal to 8 V",
    ),
    "one side": (
        "signal [%],q_pa [l/min],q_pb [l/min],q_at [l/min],q_bt [l/min]\n"
        "0,0,1,1,0\n100,9,0,0,9\n",
        "curve.csv: the signal ends at 0 %, not at the full signal (-100 %)",
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", REFUSED)
def test_a_hostile_table_is_refused_in_one_line(name, tmp_path):
    """File, line and column, at the place of the design that names the file."""
    table, words = REFUSED[name]
    with pytest.raises(InputError) as caught:
        design(tmp_path, table)
    (fault,) = caught.value.diagnostics
    text = fault.message + ("; " + fault.remedy if fault.remedy else "")
    if fault.path is None:  # at a line of the table
        joint = ", " if text.startswith("column") else ": "
        text = f"{Path(fault.file).name}, line {fault.line}{joint}{text}"
    assert words in text
    assert "\n" not in text
    assert fault.path in (None, "valve.flow_curve")
    assert fault.line is not None


CONTRADICTIONS = {
    "two sizes": (block("rated_flow: 10 l/min"), "valve.flow_curve"),
    "leakage": (block("leakage_flow: 0.1 l/min"), "valve.leakage_flow"),
    "lapped": (block("spool: {type: lapped}"), "valve.flow_curve"),
    "coefficients": (
        block("edge_coefficients: {pa: 1 l/min/sqrt(bar), pb: 1 l/min/sqrt(bar), "
              "at: 1 l/min/sqrt(bar), bt: 1 l/min/sqrt(bar)}"),
        "valve.flow_curve",
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", CONTRADICTIONS)
def test_contradictions_with_a_curve(name, tmp_path):
    """A second statement of size or leakage is refused at its key."""
    lines, path = CONTRADICTIONS[name]
    with pytest.raises(InputError) as caught:
        design(tmp_path, lines=lines)
    assert path in [fault.path for fault in caught.value.diagnostics]


def test_folders_pipes_and_lists_are_refused(tmp_path):
    """A folder, a list and a missing file give one line each, never a traceback."""
    (tmp_path / "folder").mkdir()
    for curve in ("folder", "[1, 2]", "../../../etc/none", '"a\\0b"'):
        with pytest.raises(InputError):
            design(tmp_path, lines=block(curve=curve))


TEXTS = st.text(max_size=300).map(lambda text: f"signal [%],q [l/min]\n{text}")


@settings(max_examples=60, deadline=None)
@given(st.binary(max_size=300) | TEXTS)
def test_any_bytes_are_a_curve_or_one_fault(content):
    """Random content never raises anything but a fault of one line."""
    data = content.encode("utf-8", "replace") if isinstance(content, str) else content
    text = data.decode("utf-8", "replace") + "\n"
    message = ""
    try:
        flow_table(DataFile(text, text))
    except InputError as error:
        message = str(error.diagnostics[0])
    assert "\n" not in message


def test_a_written_table_and_a_file_are_the_same_design(tmp_path):
    """A saved design names the file from its new folder; a portable one contains the table."""
    made = design(tmp_path, GOOD)
    other = tmp_path / "elsewhere"
    other.mkdir()
    ao.save(made, other / "saved.yaml")
    text = (other / "saved.yaml").read_text("utf-8")
    assert "flow_curve: ../curve.csv" in text.replace("'", "")
    again = ao.read(other / "saved.yaml")
    assert spec_hash(again.subject()) == spec_hash(made.subject())
    assert to_yaml(again.design, again.source) == text
    bare = ao.read(to_yaml(portable(made.design)))
    assert (bare.design.valve.flow_curve.label, bare.design.valve.flow_curve.inside) == (
        "curve.csv", True,
    )  # fmt: skip
    assert spec_hash(bare.subject()) == spec_hash(made.subject())
    changed = design(tmp_path, GOOD.replace("50,9", "50,8"))
    assert spec_hash(changed.subject()) != spec_hash(made.subject())


def test_a_report_repeats_without_the_file(tmp_path):
    """`rerun` needs only the PDF, to which the table is attached."""
    made = design(tmp_path, GOOD)
    assert made.source.file.endswith("design.yaml")
    out = tmp_path / "out"
    assert run("evaluate", tmp_path / "design.yaml", "--report", "--out", out).code in (0, 1)
    (tmp_path / "curve.csv").unlink()
    assert ao.rerun(out / "design.pdf").repeats is True


def test_the_report_shows_the_whole_curve_and_the_hysteresis(tmp_path):
    """Flow over the whole signal, and the bands of signal and position."""
    made = design(tmp_path, GOOD, block("hysteresis: 3 %", "threshold: 1 %"))
    evaluation = ao.evaluate(made)
    study = evaluation.valve
    assert study.signal[-1] == pytest.approx(10.0)
    half = (study.supply_pressure - study.return_pressure) / 2
    assert np.interp(5.0, study.signal, study.curves[0].flow) / LITRE == pytest.approx(
        9 * np.sqrt(half / 35e5), rel=1e-3
    )
    blocks = page.valve_blocks(evaluation)
    gain = evaluation.metrics["position_gain"].value
    assert [row[1] for row in blocks[2].rows] == ["0.3000 V", "0.1000 V"]
    assert float(blocks[2].rows[0][2].split()[0]) == pytest.approx(0.3 / gain * 1e3, rel=1e-3)
    (note,) = [text for text in evaluation.warnings if "leave out the valve's hysteresis" in text]
    assert f"{0.15 / gain * 1e3:.3g} mm" in note
    assert evaluation.to_dict()["valve"]["hysteresis"] == pytest.approx(0.3)


def test_a_load_cylinder_has_a_curve_too(tmp_path):
    """A scenario reads the curve of its load cylinder's valve from its own folder."""
    (tmp_path / "load.csv").write_text(GOOD, "utf-8")
    text = (
        f"name: a\ndesign: {KNEE.resolve()}\nduration: 0.1 s\nsample_time: 1 ms\n"
        "load:\n  cylinder:\n    bore: 40 mm\n    rod_diameter: 20 mm\n    dead_volume: 10 ml\n"
        "    stroke: 120 mm\n    supply_pressure: 100 bar\n"
        "    valve:\n      flow_curve: load.csv\n      rated_drop: 35 bar\n"
        "      natural_frequency: 100 Hz\n"
    )
    (tmp_path / "scenario.yaml").write_text(text, "utf-8")
    trial = ao.read_scenario(tmp_path / "scenario.yaml")
    valve = trial.scenario.load.cylinder.valve
    assert (valve.flow_curve, valve.flow_table.signal[-1]) == ("load.csv", 1.0)
    (tmp_path / "load.csv").write_text("x", "utf-8")
    with pytest.raises(InputError) as caught:
        ao.read_scenario(tmp_path / "scenario.yaml")
    (fault,) = caught.value.diagnostics
    assert (fault.file, fault.line) == (str(tmp_path / "load.csv"), 1)
    (tmp_path / "load.csv").unlink()
    with pytest.raises(InputError) as caught:
        ao.read_scenario(tmp_path / "scenario.yaml")
    assert [fault.path for fault in caught.value.diagnostics] == ["load.cylinder.valve.flow_curve"]


def test_designs_with_curves_are_changed_and_compared(tmp_path):
    """Another number keeps the table; two tables are a difference, named by file."""
    made = design(tmp_path, GOOD, block("frequency_3db: 110 Hz"))
    changed = made.changed({"valve.rated_drop": 20e5})
    assert changed.design.valve.flow_curve == made.design.valve.flow_curve
    assert flows(changed, 10.0)[0] == pytest.approx(20 * np.sqrt(35 / 20), rel=1e-4)
    (tmp_path / "other.csv").write_text(GOOD.replace("50,9", "50,8\n60,10"), "utf-8")
    other = ao.read(tmp_path / "design.yaml", set={"valve.flow_curve": "other.csv"})
    found = ao.compare(made, other)
    (change,) = [change for change in found.changes if change.path == "valve.flow_curve"]
    assert change.values == ("curve.csv", "other.csv")
    assert "other.csv" in str(found)
    lapped = design(tmp_path, GOOD, [
        "rated_flow: 20 l/min", "natural_frequency: 120 Hz",
        "spool: {type: lapped, stroke: 0.5 mm, clearance: 3 um}",
    ])  # fmt: skip
    moved = lapped.changed({"valve.spool.overlap": 2e-6}).design.valve
    assert moved.spool.overlap == 2e-6
