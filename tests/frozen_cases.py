"""Cases of the frozen outputs: which commands run on which shipped files.

A case is a list of steps in one folder, which holds a copy of ``designs/``. Each step is a
command line. Its outputs go to ``tests/frozen/NAME.txt``.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from math import pi
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
SHIPPED = ROOT / "designs"
EXACT, SEARCHED = 1e-9, 1e-6
"""Relative tolerances of numbers: of an evaluation, and of what an iteration ends at."""


@dataclass(frozen=True)
class Step:
    """A command line, and which of its outputs are frozen."""

    words: tuple[str, ...]
    stdin: str = ""
    json: bool = True
    """Whether it runs with ``--json`` too."""
    looks: int = 16
    """In how many looks its text is frozen."""


@dataclass(frozen=True)
class Case:
    """Steps that follow one another in a folder."""

    name: str
    steps: tuple[Step, ...]
    tolerance: float = EXACT
    seconds: float = 1.0
    """Rough time, by which cases are started: the longest first."""


def step(line: str, *more: str, stdin: str = "", json: bool = True, looks: int = 16) -> Step:
    """A step from words parted by spaces, then words that hold spaces."""
    return Step((*line.split(), *more), stdin, json, looks)


def designs() -> list[str]:
    """Names of the shipped designs."""
    return sorted(path.stem for path in SHIPPED.glob("*.yaml"))


def scenarios() -> list[str]:
    """Names of the shipped scenarios."""
    return sorted(path.stem for path in (SHIPPED / "scenarios").glob("*.yaml"))


CYCLING = frozenset({"knee_walking", "flight_control"})
"""Designs with duty cycles, whose searches take minutes: optima and uncertainty are not frozen."""
SLOW = {"huang_110_80_560": 20.0, "servo_knee": 20.0, "aerospace": 6.0}
"""Seconds of designs that take longer than others."""
STEP = "designs/scenarios/knee_step.yaml"
DATE = ("--date", "2026-01-31")


def _of_design(name: str) -> Iterator[Case]:
    """What every design goes through."""
    file, slow = f"designs/{name}.yaml", SLOW.get(name, 2.0)
    yield Case(f"check/{name}", (step(f"check {file}", looks=1),))
    yield Case(f"evaluate/{name}", (step(f"evaluate {file}"),), seconds=slow / 4)
    yield Case(f"report/{name}", (step(f"report {file} --out out", *DATE, looks=0),), seconds=slow)
    formats = "--format step --format dxf --format xlsx"
    yield Case(
        f"export/{name}",
        (step(f"export {file} {formats} --out out", *DATE, looks=0),),
        seconds=slow / 4,
    )
    seals = [step(f"seal {file} --seal {place}") for place in ("piston", "rod")]
    yield Case(f"seal/{name}", tuple(seals), SEARCHED, slow / 4)
    if name not in CYCLING:
        study = step(f"uncertainty {file} -n 300 --index-rows 0")
        yield Case(f"uncertainty/{name}", (study,), SEARCHED, slow)
        search = step(f"optimise {file} --out out --no-record", *DATE)
        yield Case(f"optimise/{name}", (search,), SEARCHED, slow)
    texts = (
        step(f"init --from {file}", json=False, looks=4),
        step(f"init --scenario {file}", json=False, looks=4),
    )
    yield Case(f"init/{name}", texts)
    vary = ("--vary", "fluid.temperature=20 degC,40 degC")
    yield Case(
        f"sweep/{name}",
        (step(f"sweep {file} --workers 1 --no-record --csv out/rows.csv", *vary),),
        seconds=slow / 4,
    )


def _stated() -> Case:
    """Cylinders stated by their numbers: what needs parts is refused."""
    files = sorted(path.name for path in (SHIPPED / "stated").glob("*.yaml"))
    lines = [
        step(f"{words} designs/stated/{file}", json=False, looks=1)
        for file in files
        for words in ("init --scenario", "evaluate")
    ]
    return Case("init/stated", tuple(lines))


def _of_scenario(name: str) -> Case:
    line = f"simulate designs/scenarios/{name}.yaml --verify --csv out/signals.csv --report"
    return Case(
        f"simulate/{name}",
        (step(f"check designs/scenarios/{name}.yaml", looks=1), step(f"{line} --out out", *DATE)),
        SEARCHED,
        3.0,
    )


def bending_record() -> str:
    """A bending test of a rod: two triangles of force, with a little friction."""
    modulus, span, outer, inner = 205e9, 0.3, 13e-3, 6e-3
    stiffness = 48 * modulus * pi * (outer**4 - inner**4) / 64 / span**3
    lines = ["t [s],F_L [N],w [mm]"]
    for i in range(400):
        place, way = divmod(i % 200, 100)
        part = way / 100 if place == 0 else 1 - way / 100
        force = 600 * part * (1.01 if place == 0 else 0.99)
        lines.append(f"{i / 100:.2f},{force:.4f},{600 * part / stiffness * 1e3:.6f}")
    return "\n".join(lines) + "\n"


def _others() -> Iterator[Case]:
    """Options and commands that one design or none shows well enough."""
    knee, steel = "designs/knee_bonded.yaml", "designs/steel_baseline.yaml"
    aerospace, servo = "designs/aerospace.yaml", "designs/servo_knee.yaml"
    record, write = "designs/records/knee_bench.csv", "--write out/best.yaml"
    quick = "--starts 2 --no-record"
    yield Case("check/all", (step("check " + " ".join(f"designs/{x}.yaml" for x in designs())),))
    yield Case(
        "evaluate/options",
        (
            step(f"evaluate {knee} --report --out out --set supply.pressure=18000000", *DATE),
            step(f"evaluate {knee} --plugin designs/scripts/custom_metric.py", json=False, looks=4),
            step("evaluate -", stdin=_edited(), json=False, looks=4),
            step(f"evaluate {knee} --quiet", json=False, looks=1),
        ),
        seconds=3.0,
    )
    yield Case(
        "optimise/infeasible",
        (
            step(
                f"optimise {knee} {quick} --out out {write}", "--set",
                "requirements.stiffness_min.min=60 kN/mm",
            ),
        ),
        SEARCHED,
        6.0,
    )  # fmt: skip
    for name, line, seconds in (
        ("certify", f"{knee} --certify", 8.0),
        ("written", f"{steel} {write}", 3.0),
        ("whole_plies", f"{aerospace} --whole-plies {write}", 20.0),
        ("standard_sizes", f"{steel} --standard-sizes {write}", 4.0),
        ("yield", f"{steel} --yield 0.9 {write}", 15.0),
        ("algorithm", f"{steel} --algorithm LD_MMA", 4.0),
    ):
        yield Case(
            f"optimise/{name}", (step(f"optimise {line} {quick} --out out", *DATE),),
            SEARCHED, seconds,
        )  # fmt: skip
    verified = f"optimise {servo} --starts 1 --no-record --verify-dynamics {STEP}"
    yield Case("optimise/verify_dynamics", (step(f"{verified} --out out"),), SEARCHED, 20.0)
    for name, file in (("knee_bonded", knee), ("steel_baseline", steel), ("elasswad_knee", None)):
        line = f"sensitivity {file or 'designs/elasswad_knee.yaml'} --out out"
        yield Case(f"sensitivity/{name}", (step(line, *DATE),), SEARCHED, 3.0)
    yield Case(
        "uncertainty/options",
        (
            step(
                f"uncertainty {knee} -n 320 --quasi --index-rows 16 --csv out/draws.csv --report "
                "--metric push_force --out out",
                *DATE,
            ),
        ),
        SEARCHED,
        4.0,
    )
    yield Case(
        "compare/designs",
        (
            step(f"compare {knee} {steel} --out out"),
            step(f"compare {steel} {servo} {aerospace} designs/elasswad_knee.yaml"),
            step("compare designs/aalto_40_25_220.yaml designs/course_cylinder.yaml"),
        ),
        seconds=3.0,
    )
    yield Case("compare/optimised", (step(f"compare {knee} {steel} --optimise"),), SEARCHED, 6.0)
    ranges = ("--vary", "cylinder.bore=21 mm..25 mm:5", "--vary", "retention.length=14 mm,24 mm")
    one = f"sweep {knee} --workers 1 --no-record"
    drawn = "--figure parallel --figure scatter --figure contour --figure ucurves"
    yield Case(
        "sweep/options",
        (
            step(
                f"{one} --csv out/a.csv --parquet out/a.parquet "
                f"{drawn} --show mass --show stiffness_min --out out",
                *ranges,
            ),
            step(f"{one} --method sobol -n 16 --csv out/b.csv", *ranges[:2]),
            step(f"{one} --method lhs -n 16 --seed 3 --csv out/c.csv", *ranges[:2]),
            step(f"{one} --method sobol -n 64 --reduce best:3", *ranges[:2]),
            step(f"sweep {aerospace} --workers 2 --no-record -n 12 --method sobol --csv out/d.csv",
                 "--vary", "cylinder.bore=40 mm..60 mm"),
        ),
        seconds=6.0,
    )  # fmt: skip
    trade = "--objective mass:min --objective stiffness_min:max"
    yield Case(
        "pareto/knee",
        (step(f"pareto {knee} {trade} -n 8 --checks 1 --no-record --csv out/front.csv --report "
              "--out out", *DATE),),
        SEARCHED,
        4.0,
    )  # fmt: skip
    yield Case(
        "pareto/three",
        (step(f"pareto {steel} {trade} --objective friction_running:min -n 6 --checks 1 "
              "--no-record --report --out out", *DATE),),
        SEARCHED,
        6.0,
    )  # fmt: skip
    huang = "designs/huang_110_80_560.yaml"
    yield Case(
        "seal/options",
        (
            step(f"seal {knee} --seal piston --finite-elements --report --map --out out "
                 "--write contact.yaml --speed", "0.05 m/s", *DATE),
            step(f"seal {huang} --seal rod --report --out out --pressure", "60 bar", *DATE),
            step("seal designs/aalto_40_25_220.yaml --seal rod --report --out out", *DATE),
        ),
        SEARCHED,
        20.0,
    )  # fmt: skip
    rig, servos = STEP, "designs/scenarios/course_position_servo.yaml"
    yield Case(
        "simulate/options",
        (
            step(f"simulate {rig} --set load.force[0].value=1000 --csv out/a.csv"),
            step(f"simulate {rig} --measured out/a.csv --fit air_content --units SI --report "
                 "--out out"),
            step(f"simulate {servos} --sensitivity"),
            step(f"simulate {servos} --set control.tuning=ziegler_nichols --set control.law=pid"),
        ),
        SEARCHED,
        25.0,
    )  # fmt: skip
    bench = f"{record} --design {knee}"
    bend = f"identify - --design {knee} --span"
    yield Case(
        "identify/knee_bench",
        (
            step(f"identify {bench} --csv out/series.csv --report --out out", *DATE),
            step(f"identify {bench} --bootstrap 40 --cutoff", "20 Hz"),
            step(f"identify {bench} --load-force", "0 N"),
        ),
        SEARCHED,
        15.0,
    )
    yield Case(
        "identify/bending",
        (
            step(bend, "300 mm", stdin=bending_record()),
            step(f"{bend}", "300 mm", "--part", "barrel", stdin=bending_record()),
        ),
        SEARCHED,
    )
    yield Case(
        "calibrate/knee_bench",
        (
            step(f"calibrate {bench} --write out/measured.yaml --report --out out", *DATE),
            step(f"calibrate {bench} --no-optimise"),
        ),
        SEARCHED,
        8.0,
    )
    kinds = ("metal", "ply", "polymer", "fluid", "seal", "adhesive")
    yield Case(
        "materials/list",
        (
            step("materials list", looks=4),
            *(step(f"materials list --kind {x}", json=False, looks=4) for x in kinds),
        ),
    )
    shown = ("al_7075_t6", "t700_epoxy", "back_up_ptfe", "iso_vg_32", "nbr_90", "epoxy_structural")
    yield Case(
        "materials/show", tuple(step(f"materials show {x}", json=False, looks=4) for x in shown)
    )
    yield Case(
        "materials/compare",
        (
            step("materials compare al_7075_t6 ti_6al4v steel_42crmo4", looks=4),
            step("materials compare iso_vg_32 iso_vg_46", json=False, looks=4),
            step("materials show iso_vg_32 --out out", json=False, looks=1),
        ),
    )
    words = ("stiffness_min", "3.1", "plug_thread", "nbr_90", "margin", "retention")
    yield Case(
        "explain/knee",
        (
            *(step(f"explain {word} designs/knee.yaml", looks=4) for word in words),
            step("explain barrel.layup[1].thickness designs/knee.yaml", looks=4),
            step("explain stifness", looks=1),
        ),
        seconds=4.0,
    )
    yield Case(
        "list/knee",
        (
            step("list metrics designs/knee.yaml stiffness", looks=1),
            step("list paths designs/knee.yaml rod", looks=1),
            step("list checks designs/knee.yaml", looks=1),
            *(step(f"list {kind}", looks=1) for kind in ("joints", "seals", "laws", "terms")),
            step("list materials carbon", looks=1),
        ),
        seconds=2.0,
    )
    yield Case("schema/design", (step("schema", looks=0),))
    yield Case("schema/scenario", (step("schema --scenario", looks=0),))
    yield Case("docs/faults", (step("docs", "", looks=1), step("docs", "a\tb", looks=1)))
    yield Case("doctor/names", (step("doctor --out out", looks=0),))
    yield Case(
        "init/plain",
        (
            step("init", json=False, looks=4),
            step("init", "left knee", json=False, looks=1),
            step("init --out other.yaml", json=True, looks=0),
        ),
    )
    joints = (
        f"init --cycle designs/cycles/{name}.csv --yes"
        for name in ("gait_knee", "run_knee", "squat_rise_synthetic")
    )
    yield Case(
        "init/cycle",
        (
            *(step(joint, "--lever-arm", "50 mm", looks=1) for joint in joints),
            step("init --cycle designs/cycles/flight_control_synthetic.csv --yes", looks=1),
        ),
        SEARCHED,
        6.0,
    )
    recorded = "--out out --date 2026-01-31"
    yield Case(
        "runs/optimise",
        (
            step(f"optimise {steel} --starts 2 {recorded}", json=False, looks=1),
            step("runs list"),
            step("runs show last --out out"),
            step(f"report last {recorded}", looks=0),
            step(f"compare {steel} last"),
            step("rerun out/steel_baseline.pdf --no-record --out again"),
            step("runs prune --keep 0", json=False, looks=1),
            step("runs list"),
        ),
        SEARCHED,
        10.0,
    )
    yield Case(
        "runs/pareto",
        (
            step(f"pareto {steel} {trade} -n 5 --checks 1 --report {recorded}", json=False,
                 looks=1),
            step("runs list"),
            step("runs show last"),
            step(f"report last {recorded}", looks=0),
            step("explore last --out out", looks=0),
            step("rerun out/steel_baseline_pareto.pdf --no-record"),
            step("runs delete last", json=False, looks=1),
        ),
        SEARCHED,
        10.0,
    )  # fmt: skip
    yield Case(
        "runs/sweep",
        (
            step(f"sweep {aerospace} --workers 1 --method sobol -n 24 --store out/rows.db",
                 "--vary", "cylinder.bore=40 mm..60 mm", "--vary",
                 "supply.pressure=180 bar..280 bar", looks=0),
            step("runs show last", looks=0),
            step("explore last --out out", looks=0),
            step("explore out/rows.db --rows 5 --out out/few.html", looks=0),
            step(f"report last {recorded}", looks=0),
        ),
        SEARCHED,
        4.0,
    )  # fmt: skip
    yield Case(
        "rerun/evaluation",
        (
            step(f"evaluate {knee} --report {recorded}", looks=0),
            step("rerun out/knee_bonded.pdf --out again"),
        ),
    )


def _edited(*changes: tuple[str, str], name: str = "knee_bonded") -> str:
    """The text of a shipped file with its first (old) replaced by (new)."""
    text = (SHIPPED / f"{name}.yaml").read_text(encoding="utf-8")
    for old, new in changes:
        if old not in text:
            raise ValueError(f"designs/{name}.yaml has no {old!r}: adapt the fault in {__file__}")
        text = text.replace(old, new, 1)
    return text


FAULTS: tuple[tuple[str, tuple[tuple[str, str], ...]], ...] = (
    ("knee_bonded", (("  pressure: 210 bar", "  presure: 210 bar"),)),
    ("knee_bonded", (("cylinder:\n", "cylindre:\n"),)),
    ("knee_bonded", (("  bore: 23 mm", "  bore: 23 bar"),)),
    ("knee_bonded", (("  bore: 23 mm", "  bore: 23"),)),
    ("knee_bonded", (("  bore: 23 mm", "  bore: wide"),)),
    ("knee_bonded", (("  bore: 23 mm", "  bore: -23 mm"),)),
    ("knee_bonded", (("  bore: 23 mm\n", ""),)),
    ("knee_bonded", (("mount: cap_clevis", "mount: cap_clevice"),)),
    ("knee_bonded", (("end_stop: internal", "end_stop: inside"),)),
    ("knee_bonded", (("type: o_ring", "type: oring"),)),
    ("knee_bonded", (("back_up: both", "back_up: two"),)),
    ("knee_bonded", (("compound: nbr_90", "compound: nbr_91"),)),
    ("knee_bonded", (("compound: nbr_90", "compound: al_7075_t6"),)),
    ("knee_bonded", (("material: iso_vg_32", "material: iso_vg_33"),)),
    ("knee_bonded", (("  type: bond", "  type: glue"),)),
    ("knee_bonded", (("  type: bond", "  type: thread"),)),
    ("knee_bonded", (("    friction_coefficient: 0.10", "    friction: films"),)),
    ("knee_bonded", (("    friction_coefficient: 0.10", "    friction_coeficient: 0.10"),)),
    ("knee_bonded", (("    section: 1.78 mm", "    series: iso_3601"),)),
    ("knee_bonded", (("    section: 1.78 mm", "    housing: iso_5597"),)),
    ("knee_bonded", (("direction: push", "direction: pushing"),)),
    ("knee_bonded", (("    speed: 0.1 m/s", "    position: middle\n    speed: 0.1 m/s"),)),
    ("knee_bonded", (("name: swing", "name: stance"),)),
    ("knee_bonded", (("  cylinder.bore:\n", "  cylinder.boar:\n"),)),
    ("knee_bonded", (("    lower: 16 mm", "    lower: 60 mm"),)),
    ("knee_bonded", (("  stiffness_min:\n", "  stifness_min:\n"),)),
    ("knee_bonded", (("    min: 10 kN/mm", "    min: 10 N*m"),)),
    ("knee_bonded", (("  minimise: mass", "  minimise: weight"),)),
    ("knee_bonded", (("  minimise: mass", "  minimize: mass"),)),
    ("knee_bonded", (("  outer_diameter: 13 mm", "  outer_diameter: 5 mm"),)),
    ("knee_bonded", (("  outer_diameter: 13 mm", "\touter_diameter: 13 mm"),)),
    ("knee_bonded", (("  seal_section:", "  seal_sections:"),)),
    ("aerospace", (("criterion: hashin", "criterion: hashing"),)),
    ("aerospace", (("type: tie_rods", "type: tierods"),)),
    ("aalto_40_25_220", (("type: step_ring", "type: step_rings"),)),
    ("aalto_40_25_220", (("model: isotropic", "model: isotropical"),)),
    ("aalto_40_25_220", (("type: hose", "type: horse"),)),
    ("huang_110_80_560", (("friction: film", "friction: filmy"),)),
    ("huang_110_80_560", (("type: compact", "type: compat"),)),
    ("huang_110_80_560", (("friction: film", "friction_coefficient: 0.1\n    friction: film"),)),
    ("scenarios/course_position_servo", (("shape: step", "shape: steps"),)),
    ("scenarios/course_position_servo", (("coulomb: 500 N", "colomb: 500 N"),)),
    ("scenarios/course_position_servo", (("duration: 3 s", "duration: 3 mm"),)),
    ("scenarios/course_position_servo", (("friction:\n", "friction:\n  model: lugree\n"),)),
    ("scenarios/course_position_servo", (("control:\n", "control:\n  law: pdi\n"),)),
    ("scenarios/course_position_servo", (("control:\n", "control:\n  tuning: ziegler\n"),)),
    ("scenarios/course_position_servo", (("  overshoot:", "  overshot:"),)),
    ("scenarios/aalto_one_way_rig", (("ends: reducing_valve", "ends: reducing"),)),
)  # fmt: skip
"""Faults of files: the shipped file, and what is replaced in it."""


def _faults() -> Iterator[Case]:
    knee = "designs/knee_bonded.yaml"
    wrong = [
        step(
            "check -",
            stdin=_edited(*changes, name=name).replace(
                "design: ../", "design: designs/" if "scenarios" in name else "design: ../"
            ),
            looks=1,
        )
        for name, changes in FAULTS
    ]
    yield Case("faults/files", tuple(wrong), seconds=3.0)
    usage = (
        step("evaluat designs/knee_bonded.yaml", looks=1),
        step("evaluate", looks=1),
        step("evaluate designs/knee_bonded.yaml --jsn", looks=1),
        step("evaluate designs/missing.yaml", looks=1),
        step("evaluate designs", looks=1),
        step(f"evaluate {knee} --set cylinder.boar=30", looks=1),
        step(f"evaluate {knee} --set cylinder.bore", looks=1),
        step(f"evaluate {knee} --set", "cylinder.bore=30 bar", looks=1),
        step(f"evaluate {knee} --set seals.piston.type=oring", looks=1),
        step(f"evaluate {knee} --set barrel.layup[7].angle=1", looks=1),
        step(f"evaluate {knee} --set load_cases[jump].force=1", looks=1),
        step(f"evaluate {knee} --report --date 31.1.2026", looks=1),
        step(f"evaluate {knee} --plugin missing.py", looks=1),
        step(f"optimise {knee} --algorithm NEWTON --out out", looks=1),
        step(f"optimise {knee} --starts 0 --out out", looks=1),
        step(f"optimise {knee} --yield 2 --out out", looks=1),
        step(f"optimise {knee} --whole-plies --out out", looks=1),
        step(
            f"optimise {knee} --verify-dynamics designs/scenarios/knee_step.yaml --out out", looks=1
        ),
        step(f"sweep {knee}", looks=1),
        step(f"sweep {knee} --vary cylinder.bore=1..2", looks=1),
        step(f"sweep {knee} --method random --vary", "cylinder.bore=20 mm..30 mm:3", looks=1),
        step(f"sweep {knee} --reduce best --vary", "cylinder.bore=20 mm..30 mm:3", looks=1),
        step(f"sweep {knee} --figure pie --vary", "cylinder.bore=20 mm..30 mm:3", looks=1),
        step(f"pareto {knee} --objective mass:min", looks=1),
        step(f"pareto {knee} --objective mass:min --objective wight:min", looks=1),
        step(f"pareto {knee} --objective mass:min --objective push_force:most", looks=1),
        step(f"compare {knee}", looks=1),
        step(f"seal {knee} --seal wiper", looks=1),
        step(f"seal {knee} --seal piston --speed", "3 bar", looks=1),
        step("simulate designs/knee_bonded.yaml", looks=1),
        step("simulate designs/scenarios/knee_step.yaml --fit air_content", looks=1),
        step(f"identify missing.csv --design {knee}", looks=1),
        step(f"identify designs/records/knee_bench.csv --design {knee} --column p9=p1", looks=1),
        step(f"identify designs/records/knee_bench.csv --design {knee} --part rod", looks=1),
        step(f"calibrate designs/records/knee_bench.csv --design {knee} --bootstrap 3", looks=1),
        step(f"export {knee} --format stp --out out", looks=1),
        step(f"uncertainty {knee} -n 3", looks=1),
        step("report nothing.yaml --out out", looks=1),
        step("report last --out out", looks=1),
        step("explore missing.db --out out", looks=1),
        step("studio missing.yaml --no-browser", looks=1),
        step("rerun designs/knee_bonded.yaml", looks=1),
        step("materials show al_7075", looks=1),
        step("materials list --kind metals", looks=1),
        step("materials compare al_7075_t6", looks=1),
        step("runs show 20200101", json=False, looks=1),
        step("runs delete last", looks=1),
        step(f"init --from {knee} --scenario {knee}", looks=1),
        step("--version", json=False, looks=1),
    )
    yield Case("faults/usage", usage, seconds=4.0)


def commands() -> list[tuple[str, ...]]:
    """Every command of the command line, as words; hidden ones are left out."""
    from actuator_opt import cli

    found: list[tuple[str, ...]] = []
    for name, command in cli.command_line().commands.items():
        below = getattr(command, "commands", {})
        if not command.hidden:
            found += [(name, inner) for inner in below] or [(name,)]
    return found


def cases() -> list[Case]:
    """Every case."""
    groups = sorted({words[0] for words in commands() if len(words) == 2})
    helps = [(), *((group,) for group in groups), *commands()]
    found = [Case("help", tuple(Step((*words, "--help"), json=False, looks=4) for words in helps))]
    for name in designs():
        found += _of_design(name)
    found += map(_of_scenario, scenarios())
    found.append(_stated())
    return [*found, *_others(), *_faults()]
