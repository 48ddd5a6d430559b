"""Designs of every kind through `evaluate` and `check`: an answer or clear lines, nothing else."""

from __future__ import annotations

import pytest
from cli_runner import BENCH, bench, block, evaluated, refused, run

import actuator_opt as ao
from actuator_opt.models.seals import LAWS

ONE_CASE = "load_cases:\n  - name: a\n    direction: push\n    force: 1 kN\n"
LINES = (
    "lines:\n  - chamber: a\n    length: 0.5 m\n    inner_diameter: 6 mm\n"
    "    outer_diameter: 8 mm\n    material: steel_e235\n"
)
THREAD = "  thread:\n    diameter: 6 mm\n    pitch: 1 mm\n"
SCREWED = "  thread:\n    pitch: 1.5 mm\n"
SCREWED_ON = "barrel:\n  layup:\n    - material: steel_e355\n      thickness: 3 mm\n\n"


def without(*names):
    """Pairs that take blocks out of the bench design."""
    return [(block(name), "") for name in names]


def layers(*entries):
    """Pairs that give the bench design other layers (and no variables, which name the old)."""
    text = "barrel:\n  layup:\n" + "".join(
        f"    - material: {material}\n      thickness: {thickness}\n      angle: {angle} deg\n"
        for material, thickness, angle in entries
    )
    return [(block("barrel"), text + "\n"), *without("variables")]


@pytest.mark.parametrize("mount", ["cap_clevis", "head_flange", "head_trunnion", "cap_flange"])
@pytest.mark.parametrize("end_stop", ["internal", "external"])
def test_mounts_and_end_stops(mount, end_stop):
    """Every mount with every end stop has an answer; an external stop takes no energy inside."""
    sets = [f"cylinder.mount={mount}", f"cylinder.end_stop={end_stop}"]
    data = evaluated(BENCH, *(word for pair in sets for word in ("--set", pair)))
    energy = data["metrics"]["end_stop_energy"]["value"]
    assert (energy is None) == (end_stop == "external")


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("hardness", ["gent", "ruess"])
def test_seal_laws(law, hardness):
    """Every contact law with every hardness model gives a friction above zero."""
    sets = [
        f"seals.{seal}.{key}={value}"
        for seal in ("piston", "rod")
        for key, value in (("law", law), ("hardness_model", hardness))
    ]
    data = evaluated(BENCH, *(word for pair in sets for word in ("--set", pair)))
    assert data["metrics"]["friction_running"]["value"] > 0


STEEL = ("steel_42crmo4", "2 mm", 0)
PLY = ("t700_epoxy", "2 mm", 55)


@pytest.mark.parametrize("model", ["auto", "thin_laminate", "as_published"])
@pytest.mark.parametrize(
    "entries",
    [
        [STEEL],
        [PLY],
        [("t700_epoxy", "2 mm", 0)],
        [("t700_epoxy", "2 mm", 90)],
        [("al_7075_t6", "1 mm", 0), STEEL],
        [("al_7075_t6", "0.5 mm", 30), PLY, ("t700_epoxy", "1 mm", 20)],
        [("guide_acetal", "3 mm", 0)],
        [("t700_epoxy", "20 mm", 45)],
        [PLY] * 24,
    ],
    ids=lambda entries: "+".join(entry[0] + entry[1] for entry in entries[:3]),
)
def test_barrels(model, entries):
    """Every wall model on metal, plastic, composite, mixed, thin and thick walls."""
    data = evaluated(bench(*layers(*entries), ("barrel:\n", f"barrel:\n  model: {model}\n")))
    assert data["metrics"]["bore_growth"]["value"] > 0
    assert data["metrics"]["mass"]["value"] > 0


def test_isotropic_barrel():
    """The isotropic model takes one layer, and refuses more of them at its place."""
    one = bench(*layers(STEEL), ("barrel:\n", "barrel:\n  model: isotropic\n"))
    assert evaluated(one)["metrics"]["burst_factor"]["value"] > 1
    (fault,) = refused(bench(("barrel:\n", "barrel:\n  model: isotropic\n")))
    assert fault["path"] == "barrel.model"


@pytest.mark.parametrize(
    "changes",
    [
        without("environment"),
        without("clevis"),
        without("load"),
        without("variables"),
        without("requirements"),
        without("waivers"),
        without("variables", "requirements", "waivers", "environment", "clevis", "load"),
        without("retention", "variables"),
        [("load:\n", LINES + "\nload:\n")],
        [("load:\n", LINES + LINES.removeprefix("lines:\n") + "\nload:\n")],
        [("  thread:\n    diameter: 10 mm\n    pitch: 1.25 mm\n", "")],
        [("  port_diameter: 6 mm\n", "")],
        [("  end_stop: internal\n", "  mount_stiffness: 100 kN/mm\n")],
        [(block("barrel"), SCREWED_ON), *without("variables"),
         ("  material: epoxy_structural\n", SCREWED), ("type: bond", "type: thread")],
        [("  material: epoxy_structural\n", "  material: steel_bolt_10_9\n" + THREAD),
         ("type: bond", "type: tie_rods"), ("  wall: 2 mm\n", "")],
        [("    compound: nbr_90\n", "    compound: nbr_90\n    count: 0\n")],
        [("objective:\n  minimise: mass", "materials:\n  t700_epoxy:\n    density: 1600 kg/m^3")],
        [("  length: 14 mm\n", "  length: 14 mm\n  bearing: guide_ptfe_bronze\n")],
    ],
)  # fmt: skip
def test_optional_parts(changes):
    """What may be left out or added changes the answer, never breaks it."""
    evaluated(bench(*changes))


@pytest.mark.parametrize(
    "name",
    ["fluid", "supply", "cylinder", "barrel", "rod", "piston", "head", "caps", "seals",
     "load_cases"],
)  # fmt: skip
def test_parts_every_actuator_has(name):
    """A missing block, an empty one, a list and a word are each one fault, with no echoes."""
    if name not in ("head", "caps"):  # these have defaults
        (fault,) = refused(bench((block(name), "")))
        assert fault["path"] == name
    faults = refused(bench((block(name), f"{name}:\n")))
    assert [(fault["path"], fault["message"]) for fault in faults] == [(name, "no value")]
    for odd in ("hello", "[1, 2]", "12 mm"):
        faults = refused(bench((block(name), f"{name}: {odd}\n")))
        if not (name == "load_cases" and odd == "[1, 2]"):
            assert [fault["path"] for fault in faults] == [name]
        assert all(fault["line"] for fault in faults)


@pytest.mark.parametrize("name", ["variables", "requirements", "waivers", "environment", "clevis"])
@pytest.mark.parametrize("odd", ["", " hello", " [1, 2]", " 3"])
def test_optional_parts_of_the_wrong_shape(name, odd):
    """What may be left out must still have its shape."""
    assert refused(bench((block(name), f"{name}:{odd}\n")))[0]["path"] == name


@pytest.mark.parametrize(
    "case",
    [
        "    speed: 20 m/s\n",
        "    speed: 0\n",
        "    position: 0 %\n",
        "    position: 100 %\n",
        "    position: 0 mm\n",
        "    position: 110 mm\n",
        "    position: worst\n",
        "    temperature: -100 degC\n",
        "    temperature: 300 degC\n",
        "    pressure: 210 bar\n",
        "    pressure: 5 bar\n",
        "    side_load: 20 MN\n",
    ],
)
@pytest.mark.parametrize("direction", ["push", "pull"])
def test_one_case_at_its_extremes(case, direction):
    """A single load case at the ends of every range is answered."""
    text = ONE_CASE.replace("push", direction) + case + "\n"
    evaluated(bench((block("load_cases"), text)))


def test_joint_torque_is_force_times_lever_arm():
    """A case stated by joint torque needs the force torque / arm: 120 N·m / 40 mm = 3 kN."""
    torque = "joint_torque: 120 N*m\n    lever_arm: 40 mm"
    text = bench((block("load_cases"), ONE_CASE.replace("force: 1 kN", torque) + "\n"))
    by_torque = evaluated(text)
    by_force = evaluated(bench((block("load_cases"), ONE_CASE.replace("1 kN", "3 kN") + "\n")))
    for name, metric in by_force["metrics"].items():
        assert by_torque["metrics"][name]["value"] == metric["value"], name
    margins = [row["margin"] for row in by_force["requirements"]]
    assert [row["margin"] for row in by_torque["requirements"]] == pytest.approx(margins)


def test_many_cases():
    """Five mixed cases and a hundred equal ones are answered, a hundred and one refused."""
    mixed = "load_cases:\n" + "".join(
        f"  - name: c{i}\n    direction: {('push', 'pull')[i % 2]}\n    force: {i} kN\n"
        f"    position: {20 * i} %\n    speed: 0.{i} m/s\n    temperature: {15 * i} degC\n"
        f"    pressure: {100 + 20 * i} bar\n"
        for i in range(5)
    )
    data = evaluated(bench((block("load_cases"), mixed + "\n")))
    assert {row["name"] for row in data["requirements"]} >= {f"force[c{i}]" for i in range(1, 5)}
    for count in (100, 101):
        cases = ONE_CASE + "".join(
            ONE_CASE.removeprefix("load_cases:\n").replace("name: a", f"name: a{i}")
            for i in range(count - 1)
        )
        text = bench((block("load_cases"), cases + "\n"))
        if count == 100:
            evaluated(text)
        else:
            assert [fault["path"] for fault in refused(text)] == ["load_cases"]


FAULTY_CASES = [
    ("    force: 2 kN\n", None),
    ("    joint_torque: 120 N*m\n", "load_cases[a].joint_torque"),
    ("    lever_arm: 40 mm\n", "load_cases[a].lever_arm"),
    ("    position: 101 %\n", "load_cases[a].position"),
    ("    position: 111 mm\n", "load_cases[a].position"),
    ("    position: -1 mm\n", "load_cases[a].position"),
    ("    position: 0.5\n", "load_cases[a].position"),
    ("    position: middle\n", "load_cases[a].position"),
    ("    pressure: 211 bar\n", "load_cases[a].pressure"),
    ("    pressure: 4 bar\n", "load_cases[a].pressure"),
    ("    speed: -0.1 m/s\n", "load_cases[a].speed"),
    ("    direction: push\n", None),
    ("    spped: 1 m/s\n", "load_cases[a].spped"),
]


@pytest.mark.parametrize(("line", "path"), FAULTY_CASES)
def test_faulty_cases(line, path):
    """Each contradiction of a load case is one fault at its own line."""
    (fault,) = refused(bench((block("load_cases"), ONE_CASE + line + "\n")))
    assert fault["path"] == path
    assert fault["line"] == BENCH[: BENCH.index("load_cases:")].count("\n") + 5
    assert fault["remedy"]


ABSURD = [
    ("outer_diameter: 11.5 mm", "outer_diameter: 22 mm", "rod.outer_diameter"),
    ("outer_diameter: 11.5 mm", "outer_diameter: 21.99 mm", "seals.rod.section"),
    ("inner_diameter: 7 mm", "inner_diameter: 11.5 mm", "rod.inner_diameter"),
    ("bore: 22 mm", "bore: 1e300 mm", "cylinder.bore"),
    ("bore: 22 mm", "bore: -22 mm", "cylinder.bore"),
    ("bore: 22 mm", "bore: 0", "cylinder.bore"),
    ("bore: 22 mm", "bore: .nan", "cylinder.bore"),
    ("bore: 22 mm", "bore: nan mm", "cylinder.bore"),
    ("bore: 22 mm", "bore: .inf mm", "cylinder.bore"),
    ("bore: 22 mm", "bore: 1e999 mm", "cylinder.bore"),
    ("bore: 22 mm", "bore: 22", "cylinder.bore"),
    ("bore: 22 mm", "bore: 22 bar", "cylinder.bore"),
    ("bore: 22 mm", "bore: 22,5 mm", "cylinder.bore"),
    ("stroke: 110 mm", "stroke: 20 m", "cylinder.stroke"),
    ("return_pressure: 5 bar", "return_pressure: 210 bar", "supply.return_pressure"),
    ("stop_travel: 1 mm", "stop_travel: 0", "cylinder.stop_travel"),
    ("port_diameter: 6 mm", "port_diameter: 22 mm", "cylinder.port_diameter"),
    ("section: 1.78 mm", "section: 30 mm", "seals.piston.section"),
    ("temperature_min: 0 degC", "temperature_min: 90 degC", "environment.temperature_max"),
    ("air_content: 0.5 %", "air_content: 21 %", "fluid.air_content"),
    ("pitch: 1.25 mm", "pitch: 5 mm", "rod.thread.pitch"),
    ("barrel:\n", "barrel:\n  length: 100 mm\n", "barrel.length"),
    ("rod:\n  material: steel_42crmo4", "rod:\n  material: t700_epoxy", "rod.material"),
    ("material: iso_vg_32", "material: al_7075_t6", "fluid.material"),
    ("compound: nbr_90", "compound: iso_vg_32", "seals.piston.compound"),
    ("material: epoxy_structural", "material: steel_42crmo4", "retention.material"),
    ("    - material: al_7075_t6", "    - material: nbr_90", "barrel.layup[0].material"),
    ("minimise: mass", "minimise: weight", "objective.minimise"),
    ("minimise: mass", "minimise: mass\n  maximise: mass", "objective.maximise"),
    ("  stiffness_min:", "  stifness_min:", "requirements.stifness_min"),
    ("    min: 6 kN/mm", "    min: 6 kN", "requirements.stiffness_min.min"),
    ("    min: 6 kN/mm", "    min: 6 kN/mm\n    max: 5 kN/mm", "requirements.stiffness_min.max"),
    ("lower: 20 mm", "lower: 40 mm", "variables.cylinder.bore.upper"),
    ("lower: 20 mm", "lower: 30 mm", "variables.cylinder.bore.upper"),
    ("lower: 20 mm", "lower: 23 mm", "cylinder.bore"),
    ("lower: 20 mm", "lower: 20 mm\n    start: 19 mm", "variables.cylinder.bore.start"),
]


@pytest.mark.parametrize(("old", "new", "path"), ABSURD)
def test_absurd_values(old, new, path):
    """Every absurdity is refused at its PATH and line, in `check` and `evaluate` alike."""
    text = bench((old, new))
    faults = refused(text)
    assert [fault["path"] for fault in faults] == [path]
    assert faults[0]["line"]
    assert faults == refused(text, command="check")
    plain = run("evaluate", "-", stdin=text.encode())
    assert (plain.code, plain.out) == (3, "")
    assert plain.err.startswith(f"<stdin>:{faults[0]['line']}:")


HEAD_GAP = ("clearance: 30 um\n\ncaps", "clearance: {} mm\n\ncaps")
PISTON_GAP = ("clearance: 30 um\n\nhead", "clearance: {} mm\n\nhead")


@pytest.mark.parametrize(
    ("change", "below", "beyond", "path", "remedy"),
    [
        (("length: 22 mm", "length: {} mm"), 68.4, 69.1, "retention.length", "at most 69 mm"),
        (PISTON_GAP, 1.49, 1.5, "piston.clearance", "less than 1.495 mm"),
        (HEAD_GAP, 1.49, 1.5, "head.clearance", "less than 1.495 mm"),
    ],
)
def test_parts_that_leave_no_room(change, below, beyond, path, remedy):
    """Skirts of half the barrel, 138 mm, meet; a gland is 1.78 mm less 16 % deep: 1.495 mm."""
    old, new = change
    evaluated(bench((old, new.format(below))))
    (fault,) = refused(bench((old, new.format(beyond))), command="check")
    assert fault["path"] == path
    assert fault["line"]
    assert remedy in fault["remedy"]


def test_the_optimiser_keeps_skirts_apart():
    """The heaviest skirts end a least wall of 1 mm before they meet: (138 - 1)/2 mm each."""
    free = "variables:\n  retention.length:\n    lower: 5 mm\n    upper: 100 mm\n"
    mild = [("pressure: 210 bar", "pressure: 120 bar"), ("force: 4 kN", "force: 2 kN")]
    heavy = [("minimise: mass", "maximise: mass"), (block("variables"), free)]
    text = bench(*mild, *heavy, *without("requirements"))
    found = ao.optimise(ao.read(text), prices=False, starts=1)
    assert found.best.retention.length == pytest.approx(68.5e-3, rel=1e-6)


@pytest.mark.parametrize(
    "changes",
    [
        [("stroke: 110 mm", "stroke: 10 m"), ("outer_diameter: 11.5 mm", "outer_diameter: 3 mm"),
         ("inner_diameter: 7 mm", "inner_diameter: 0"), ("diameter: 10 mm", "diameter: 3 mm"),
         ("pitch: 1.25 mm", "pitch: 0.5 mm")],
        [("stroke: 110 mm", "stroke: 1 mm"), ("length: 22 mm", "length: 14 mm")],
        [("bore: 22 mm", "bore: 1000 mm"), *without("variables")],
        [("inner_diameter: 7 mm", "inner_diameter: 11.499 mm")],
        [("pressure: 210 bar", "pressure: 1500 bar")],
        [("pressure: 210 bar", "pressure: 1 bar"), ("return_pressure: 5 bar", "")],
        [("thickness: 0.4 mm", "thickness: 0.01 mm"), ("thickness: 1.2 mm", "thickness: 0.01 mm"),
         ("thickness: 1.6 mm", "thickness: 0.01 mm"), *without("variables")],
        [("tolerance: 0.05 mm", "tolerance: 2 mm")],
        [("dead_volume_a: 3 ml", "dead_volume_a: 100 l")],
        [("mass: 20 kg", "mass: 1000 t")],
        [("pin_diameter: 8 mm", "pin_diameter: 0.5 mm")],
        [("air_content: 0.5 %", "air_content: 20 %")],
        [("temperature: 40 degC", "temperature: -100 degC")],
    ],
)  # fmt: skip
def test_extreme_but_possible(changes):
    """The ends of every range are answered: with numbers, or null and why."""
    evaluated(bench(*changes))


GOOD_SETS = [
    ("cylinder.bore=24 mm", "cylinder.bore"),
    ("cylinder.bore=0.024", "cylinder.bore"),
    ("cylinder.bore = 0.945 in", "cylinder.bore"),
    ("barrel.layup[1].thickness=2 mm", None),
    ("load_cases[stance].force=5 kN", None),
    ("load_cases[0].force=5000", None),
    ("load_cases[stance].position=50 %", None),
    ("load_cases[stance].position=0.05", None),
    ("load_cases[stance].name=run", None),
    ("requirements.stiffness_min.min=5e6", None),
    ("requirements.mass.max=2", None),
    ("materials.t700_epoxy.density=1600", None),
    ("materials.t700_epoxy.density=1.6 g/cm^3", None),
    ("fluid.material=iso_vg_46", None),
    ("variables.cylinder.bore.upper=28 mm", None),
    ("waivers.buckling_factor=tested", None),
    ("objective.maximise=stiffness_min", None),
    ("objective.minimise=friction_running", None),
    ("name=other", None),
]


@pytest.mark.parametrize(("change", "_path"), GOOD_SETS)
def test_set(change, _path):
    """Every kind of PATH takes a value with a unit, an SI number or a text."""
    evaluated(BENCH, "--set", change)


def test_set_is_the_edit():
    """--set gives the same answer as the edited file; a bare number is SI; the last one counts."""
    edited = evaluated(bench(("bore: 22 mm", "bore: 24 mm")))["metrics"]
    for sets in (["24 mm"], ["0.024"], ["2.4 cm"], ["21 mm", "24 mm"]):
        words = [word for value in sets for word in ("--set", f"cylinder.bore={value}")]
        assert evaluated(BENCH, *words)["metrics"] == edited


BAD_SETS = [
    ("cylinder.bore=50 mm", "cylinder.bore"),
    ("cylinder.bore=24 bar", "cylinder.bore"),
    ("cylinder.bore=24", "cylinder.bore"),
    ("cylinder.bore=nan", "cylinder.bore"),
    ("cylinder.bore=-1 mm", "cylinder.bore"),
    ("cylinder=3", "cylinder"),
    ("cylinder.bor=24 mm", "cylinder.bor"),
    ("frob=3", "frob"),
    ("[0]=3", "[0]"),
    ("cylinder[0].bore=3 mm", "cylinder[0].bore"),
    ("barrel.layup[9].thickness=2 mm", "barrel.layup[9].thickness"),
    ("barrel.layup[-1].thickness=2 mm", "barrel.layup[-1].thickness"),
    ("barrel.layup.thickness=2 mm", "barrel.layup.thickness"),
    ("load_cases[nope].force=5 kN", "load_cases[nope].force"),
    ("lines[0].length=1 m", "lines[0].length"),
    ("requirements.nope.min=3", "requirements.nope.min"),
    ("requirements.stiffness_min=3", "requirements.stiffness_min"),
    ("materials.nope.density=1500", "materials.nope"),
    ("materials.t700_epoxy.frob=1", "materials.t700_epoxy.frob"),
    ("fluid.material=nope", "fluid.material"),
    ("fluid.material=t700_epoxy", "fluid.material"),
    ("variables.cylinder.stroke.upper=30 mm", "variables.cylinder.stroke.lower"),
    ("variables.cylinder.bore.middle=30 mm", "variables.cylinder.bore.middle"),
    ("objective.minimise=nope", "objective.minimise"),
    ("waivers.nope=x", "waivers.nope"),
    ("seals.piston.count=1.5", "seals.piston.count"),
    ("name=\x1b[31mred", "name"),
    ("environment.temperature_min=-10", "environment.temperature_min"),
]


@pytest.mark.parametrize(("change", "path"), BAD_SETS)
def test_set_refused(change, path):
    """A --set that cannot be is refused as one: its file is "--set", its PATH the one given."""
    (fault,) = refused(BENCH, "--set", change)
    assert (fault["file"], fault["path"]) == ("--set", path)
    assert fault["remedy"]


def test_long_and_strange_paths_stay_one_line():
    """Whatever is typed comes back as one short printable line."""
    for text in ("a" * 5000 + "=1", "cylinder.bore=1\n2", "\x07=3", "cylinder.bore=" + "9" * 5000):
        result = run("evaluate", "-", "--set", text, stdin=BENCH.encode())
        assert result.code == 3
        (line,) = result.err.splitlines()
        assert line.isprintable()
        assert len(line) < 500


def test_answers_to_a_person():
    """Without --json: text on stdout, nothing on stderr; --quiet leaves only the exit status."""
    result = run("evaluate", "-", stdin=BENCH.encode())
    assert result.code == 0
    assert result.err == ""
    for word in ("test bench", "stiffness ", "kN/mm", "requirements met", "checks not checked"):
        assert word in " ".join(result.out.split())
    whole = run("evaluate", "-", "-v", stdin=BENCH.encode())
    for word in ("test bench", "stiffness_min", "kN/mm", "requirements met", "checks:"):
        assert word in whole.out
    quiet = run("evaluate", "-", "--quiet", stdin=BENCH.encode())
    assert (quiet.code, quiet.out, quiet.err) == (0, "", "")
    missed = run("evaluate", "-", "-q", "--set", "requirements.mass.max=1 g", stdin=BENCH.encode())
    assert (missed.code, missed.out, missed.err) == (1, "", "")


def test_a_requirement_no_model_answers():
    """A limit on a metric this design does not have: null and why, and a fault for `check`."""
    text = bench(("requirements:\n", "requirements:\n  line_velocity:\n    max: 3 m/s\n"))
    data = evaluated(text)
    assert data["metrics"]["line_velocity"]["value"] is None
    row = next(row for row in data["requirements"] if row["metric"] == "line_velocity")
    assert (row["value"], row["met"]) == (None, False)
    for command in ("check", "optimise"):
        (fault,) = refused(text, command=command)
        assert fault["path"] == "requirements.line_velocity.max"
        assert "lines" in fault["message"]
        assert fault["line"] == text[: text.index("max: 3 m/s")].count("\n") + 1


@pytest.mark.parametrize(
    "path",
    ["environment.assembly_temperature", "load_cases[stance].position", "supply.proof_ratio"],
)
def test_variables_without_effect_are_told_or_work(path):
    """A variable is moved or refused as one that no model reads; never silently ignored."""
    bounds = {"environment.assembly_temperature": ("10 degC", "30 degC", "20 degC"),
              "load_cases[stance].position": ("0 mm", "50 mm", "20 mm"),
              "supply.proof_ratio": ("1", "2", "1.5")}[path]  # fmt: skip
    lower, upper, start = bounds
    text = bench(
        ("variables:\n", f"variables:\n  {path}:\n    lower: {lower}\n    upper: {upper}\n"
                         f"    start: {start}\n"),
    )  # fmt: skip
    result = run("check", "-", "--json", stdin=text.encode())
    if result.code:
        (fault,) = result.errors
        assert path in fault["path"]
        assert fault["line"]
