"""Claims about every seal type, friction law and law of contact or hardness, and their registries.

Nothing here names a type or a law that the registries do not have: a new one is tested by being
listed.
"""

from __future__ import annotations

import json
import pkgutil
import subprocess
import sys
from dataclasses import MISSING, fields, replace
from importlib import import_module
from itertools import combinations
from math import inf, isfinite

import numpy as np
import pytest
from seal_designs import evaluated, text

import actuator_opt as ao
from actuator_opt import friction, seals
from actuator_opt.base.errors import InputError
from actuator_opt.base.kinds import UnknownKind, kinds
from actuator_opt.base.numeric import STEP
from actuator_opt.base.quantities import INPUTS
from actuator_opt.design.kinds import Of
from actuator_opt.design.schema import json_schema
from actuator_opt.design.seals import SealElement
from actuator_opt.design.writer import init_text
from actuator_opt.evaluation import prepare
from actuator_opt.friction import coefficient
from actuator_opt.friction.kinds import LAWS as FRICTION_LAWS
from actuator_opt.friction.law import FrictionLaw
from actuator_opt.models.elastomer import MODULUS_LAWS
from actuator_opt.models.seals import LAWS as CONTACT_LAWS
from actuator_opt.pages.seal_sections import filled_grooves
from actuator_opt.seals import o_ring
from actuator_opt.seals.contact import GROOVE_WIDTH
from actuator_opt.seals.kinds import SIZES, TYPES
from actuator_opt.seals.seal_type import Room, SealSizes, SealType
from actuator_opt.studies import plant as plants_module
from actuator_opt.studies.plant import plant

WORDS = {
    "type": TYPES,
    "friction": FRICTION_LAWS,
    "law": CONTACT_LAWS,
    "hardness_model": MODULUS_LAWS,
}
"""Registry behind every word of a seal."""
TYPE = pytest.mark.parametrize("kind", TYPES.values(), ids=TYPES.names)
LAW = pytest.mark.parametrize("law", FRICTION_LAWS.values(), ids=FRICTION_LAWS.names)

SECTION, SQUEEZE = 3.53e-3, 0.12


# --- a sample of every type -----------------------------------------------------------------------


def block(kind, **more):
    """An element of a type as YAML: what it needs, at the examples of its sizes."""
    compound = "ptfe_bronze_nbr_70" if kind.modulus_by == "hardness" else "nbr_90"
    needed = {field.key: field.size.example for field in kind.fields if field.default is None}
    known = {"type": kind.name, "compound": compound, "section": "3.53 mm", "squeeze": "12 %"}
    every = known | needed | more
    return ", ".join(f"{key}: {value}" for key, value in every.items() if value is not None)


def stated(kind):
    """The same sizes, SI."""
    needed = [field.size for field in kind.fields if field.default is None]
    return {size.key: Of(size.quantity).validate(size.example) for size in needed}


def sample(kind, **numbers):
    """A seal of a type at no pressure; its modulus 6 MPa."""
    groove = kind.groove({"section": SECTION, "squeeze": SQUEEZE} | stated(kind))
    own = kind.sizes(stated(kind), section=SECTION, gland_depth=groove.depth)
    known = {
        "section": SECTION, "squeeze": SQUEEZE, "squeeze_left": SQUEEZE, "pressure": 0.0,
        "gland_depth": groove.depth, "groove_width": groove.width, "diameter": 0.03,
        "youngs_modulus": 6e6, "hardness": 70.0, "count": 1.0,
        "face_modulus": 5e8 if kind.modulus_by == "hardness" else 6e6,
        "face_poissons_ratio": 0.46 if kind.modulus_by == "hardness" else 0.49,
        "friction_coefficient": 0.1, "breakaway_ratio": 2.0, "stribeck_speed": 0.01,
        "viscous_friction": 30.0,
    }  # fmt: skip
    return SealSizes(known | own | numbers)


# --- registries -----------------------------------------------------------------------------------


@pytest.mark.parametrize("cls", [SealType, FrictionLaw])
def test_no_piece_of_a_kind_has_a_default(cls):
    """A kind that leaves a piece out fails where it is made: at import."""
    assert not [x.name for x in fields(cls) if x.default is not MISSING]
    good = o_ring.TYPE if cls is SealType else coefficient.LAW
    pieces = {x.name: getattr(good, x.name) for x in fields(cls)}
    for name in pieces:
        with pytest.raises(TypeError, match=name):
            cls(**{key: value for key, value in pieces.items() if key != name})


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"name": "Quad-Ring"}, "lower-case letters"),
        ({"title": None}, "title is missing"),
        ({"help": "  "}, "help is empty"),
        ({"contact": None}, "contact is missing"),
        ({"outline": "a circle"}, "outline is not a function"),
        ({"model": "seals"}, "model is not a function"),
    ],
)
def test_a_type_without_a_piece_is_refused(changes, words):
    """None, an empty text or no function where one belongs."""
    with pytest.raises(ValueError, match=words):
        kinds("seal type", replace(o_ring.TYPE, **changes))


def test_two_of_one_name_are_refused():
    """The second would hide the first."""
    with pytest.raises(ValueError, match='"o_ring": duplicate name'):
        kinds("seal type", o_ring.TYPE, replace(o_ring.TYPE, title="another"))


@pytest.mark.parametrize("registry", WORDS.values(), ids=WORDS)
def test_an_unknown_name_is_an_error_that_suggests(registry):
    """In code a wrong word never stands for a default."""
    name = registry.names[0]
    with pytest.raises(UnknownKind, match=f'did you mean "{name}"') as raised:
        registry[name[:-1]]
    assert isinstance(raised.value, KeyError)
    element = SealElement(compound="nbr_90", section=SECTION, squeeze=SQUEEZE)
    with pytest.raises(UnknownKind, match="no friction law"):
        element.model_copy(update={"friction": "filn"}).friction_law  # noqa: B018


def unlisted(package, cls, registry):
    """Kinds that a module of a package defines and its registry has not."""
    found = []
    for module in pkgutil.iter_modules(package.__path__, f"{package.__name__}."):
        found += [x for x in vars(import_module(module.name)).values() if isinstance(x, cls)]
    return sorted({x.name for x in found} - set(registry.names))


def test_every_module_is_listed():
    """A kind whose line is missing in the registry would be silently absent."""
    assert unlisted(seals, SealType, TYPES) == []
    assert unlisted(friction, FrictionLaw, FRICTION_LAWS) == []
    short = kinds("seal type", *list(TYPES.values())[1:])
    assert unlisted(seals, SealType, short) == [TYPES.names[0]]


def test_kinds_load_nothing_heavy():
    """Finite elements, figures and SciPy load when a function needs them."""
    code = (
        "import sys, actuator_opt.seals.kinds, actuator_opt.friction.kinds\n"
        "heavy = ('scipy', 'matplotlib', 'skfem', 'pydantic', 'actuator_opt.finite_elements',"
        " 'actuator_opt.evaluation', 'actuator_opt.pages')\n"
        "print([name for name in heavy if name in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


# --- words ----------------------------------------------------------------------------------------


@pytest.mark.parametrize("field", WORDS)
def test_every_word_is_in_schema_and_help(field):
    """The schema offers exactly the words of the registry, with what each means."""
    element = json_schema()["properties"]["seals"]["properties"]["rod"]["properties"]
    for where in (element, element["secondary"]["properties"]):
        assert where[field]["enum"] == list(WORDS[field])
        for kind in WORDS[field].values():
            assert f"{kind.name}: {kind.help}" in where[field]["description"]


@pytest.mark.parametrize("field", WORDS)
def test_an_unknown_word_is_a_fault_with_a_suggestion(field):
    """At its line, with the nearest word."""
    word = WORDS[field].names[-1]
    line = block(o_ring.TYPE, **{field: f"{word}x"})
    with pytest.raises(InputError) as raised:
        ao.read(text(line, block(o_ring.TYPE)))
    (fault,) = raised.value.diagnostics
    assert fault.path == f"seals.piston.{field}"
    assert fault.message == f'"{word}x" is not a choice'
    assert fault.remedy == f'did you mean "{word}"?'


def test_the_start_file_offers_every_type():
    """Beside the type it has."""
    (line,) = (x for x in init_text().splitlines() if "# or " in x and "type: o_ring" in x)
    assert line.split("# or ")[1].split(", ") == [x for x in TYPES if x != "o_ring"]


# --- seal types -----------------------------------------------------------------------------------


@TYPE
def test_more_squeeze_and_pressure_never_less_force(kind):
    """Load and peak pressure rise with squeeze and with the pressure sealed.

    Over the squeeze that the default law of a round ring was compared with data on: below, the foot
    of a step ring's O-ring takes more of the pressure behind the ring than it adds in load.
    """
    squeeze = np.linspace(*CONTACT_LAWS["energised"].squeeze_range, 18)[:, None]
    pressure = np.linspace(0.0, 12e6, 13)
    found = kind.contact(sample(kind, squeeze_left=squeeze, pressure=pressure))
    load, peak = (np.broadcast_to(x, (18, 13)) for x in (found.line_load, found.peak))
    least = -1e-9 * load.max()
    assert (np.diff(load, axis=0) >= least).all()
    assert (np.diff(load, axis=1) >= least).all()
    assert (np.diff(peak, axis=1) >= -1e-9 * peak.max()).all()
    assert (load > 0).all()


@TYPE
@pytest.mark.parametrize("on_rod", [True, False])
def test_the_profile_carries_the_load(kind, on_rod):
    """Its integral over the width is the line load: pressures of the oil included."""
    nodes = (np.arange(4000) + 0.5) / 4000
    for pressure in (0.0, 2e6, 8e6):
        seal = replace(sample(kind, pressure=pressure), on_rod=on_rod)
        found = kind.contact(seal)
        assert float(found.excess) > 0
        carried = found.profile_width * np.mean(found.profile(nodes))
        assert float(carried) == pytest.approx(float(found.line_load), rel=0.01)


@TYPE
def test_a_contact_of_arrays_is_that_of_floats(kind):
    """Every element of an array stands alone."""
    squeeze, pressure = np.array([[0.08], [0.15]]), np.array([0.0, 3e6, 9e6])
    whole = kind.contact(sample(kind, squeeze_left=squeeze, pressure=pressure))
    for i, j in np.ndindex(2, 3):
        numbers = {"squeeze_left": float(squeeze[i, 0]), "pressure": float(pressure[j])}
        single = kind.contact(sample(kind, **numbers))
        for name in ("line_load", "width", "peak", "excess"):
            value = np.broadcast_to(getattr(whole, name), (2, 3))[i, j]
            assert value == pytest.approx(float(getattr(single, name)), rel=1e-12)


@TYPE
def test_a_seal_lies_in_its_groove(kind):
    """Mounted outlines touch the counterface and stay in the groove; parts have a section."""
    numbers = sample(kind).numbers
    groove = kind.groove({"section": SECTION, "squeeze": SQUEEZE} | stated(kind))
    assert groove.width >= groove.ring_width > 0
    assert all(piece.area > 0 and 0 < piece.depth < groove.depth for piece in groove.pieces)
    shapes = kind.outline(numbers, Room(0.0, float(numbers["groove_width"]), float(groove.depth)))
    mounted = [shape.points for shape in shapes if shape.kind != "free"]
    assert mounted
    x, r = np.array([point for points in mounted for point in points]).T
    assert r.min() == pytest.approx(0.0, abs=1e-9)
    assert r.max() <= groove.depth + 1e-9
    assert x.min() >= -1e-9
    assert x.max() <= float(numbers["groove_width"]) + 1e-9


@TYPE
def test_a_type_that_has_warnings_says_them_beyond_its_range(kind):
    """None at usual numbers; a round ring far outside the data of its law says so."""
    assert list(kind.warnings(sample(kind))) == []
    if kind.round_ring:
        assert list(kind.warnings(sample(kind, pressure=1e9)))


@TYPE
def test_a_design_with_a_type_is_evaluated(kind):
    """Finite friction in every case, its model named, its words on paper, its outline drawn."""
    found = evaluated(block(kind), block(kind))
    for metric in ("friction_running", "friction_breakaway", "contact_width"):
        assert all(isfinite(x) and x > 0 for x in found.metrics[metric].by_case.values())
    said = " ".join(str(x) for x in found.models)
    assert "piston seal" in said
    json.dumps(found.to_dict(), allow_nan=False)
    assert kind.contact_model.format(law="x")
    (slot,) = filled_grooves(ao.read(text(block(kind), block(kind))).design, "rod")
    assert slot.shapes


@TYPE
def test_what_a_type_needs_and_refuses_is_a_fault(kind):
    """A needed size left out, and each size it does not have: one line at its place."""
    for key in kind.needed:
        (fault,) = faults(block(kind, **{key: None}))
        assert fault.path == f"seals.piston.{key}"
        assert fault.message.startswith("missing")
    refused = [size for size in SIZES if size.key not in (*kind.keys, GROOVE_WIDTH.key)]
    for size in refused:
        (fault,) = faults(block(kind, **{size.key: size.example}))
        assert fault.path == f"seals.piston.{size.key}"
        assert "not a size of" in fault.message
    assert not ao.check(text(block(kind), block(kind)))


def faults(line):
    """Faults of a design with a piston seal."""
    with pytest.raises(InputError) as raised:
        ao.read(text(line, block(o_ring.TYPE)))
    return raised.value.diagnostics


def test_every_size_is_a_field_of_a_design():
    """With the quantity the type states."""
    element = json_schema()["properties"]["seals"]["properties"]["rod"]["properties"]
    for size in SIZES:
        assert size.key in SealElement.model_fields
        assert size.help in element[size.key]["description"]
        assert Of(size.quantity).validate(size.example) > 0


@pytest.mark.long
@pytest.mark.parametrize("kind", [x for x in TYPES.values() if x.elements], ids=lambda x: x.name)
def test_finite_elements_are_near_the_closed_form(kind):
    """Mounted without pressure, line loads within a third: coarse, but the right seal."""
    seal = sample(kind)
    found = kind.elements.solve(seal, float(seal["groove_width"]), [])
    assert not found.failure
    expected = float(kind.contact(seal).line_load)
    assert found.contacts[0].line_load == pytest.approx(expected, rel=0.33)
    assert kind.elements.note.endswith(".")


# --- friction laws --------------------------------------------------------------------------------


@LAW
def test_slope_of_a_law_is_its_derivative(law):
    """By a complex step; no friction is negative, breakaway is not below Coulomb friction."""
    seal = sample(o_ring.TYPE)
    speeds = np.geomspace(1e-4, 0.5, 30)
    level = law.level(seal, 100.0, speeds)
    derived = np.imag(law.level(seal, 100.0, speeds + 1j * STEP)) / STEP
    np.testing.assert_allclose(law.slope(seal, 100.0, speeds), derived, rtol=1e-9, atol=1e-9)
    assert (level >= 0).all()
    breakaway = float(law.breakaway(seal, 100.0))
    assert breakaway >= 100.0
    assert breakaway == pytest.approx(float(law.level(seal, 100.0, 0.0)), rel=1e-12)


def test_a_simulation_reads_the_numbers_of_the_law(monkeypatch):
    """Where friction does not fall with speed, a Stribeck speed has no weight."""
    constant = replace(
        coefficient.LAW,
        breakaway=lambda seal, coulomb: coulomb,
        level=lambda seal, coulomb, speed: coulomb + 0.0 * speed,
        slope=lambda seal, coulomb, speed: 0.0 * (coulomb + speed),
    )
    plants = {}
    for name, law in (("coefficient", coefficient.LAW), ("constant", constant)):
        monkeypatch.setitem(FRICTION_LAWS, "coefficient", law)
        for speed in ("1 mm/s", "100 mm/s"):
            rod = block(o_ring.TYPE, stribeck_speed=speed)
            design = ao.read(text(block(o_ring.TYPE), rod)).design
            monkeypatch.setattr(plants_module, "_KEPT", {})  # keys do not contain the law
            plants[name, speed] = plant(prepare(design)).seals.stribeck_speed
    assert plants["coefficient", "1 mm/s"] < plants["coefficient", "100 mm/s"]
    assert plants["constant", "1 mm/s"] == plants["constant", "100 mm/s"]


def test_no_law_is_a_copy_of_another():
    """Something besides word and help tells two laws apart."""
    bare = [replace(law, name="x", help="x") for law in FRICTION_LAWS.values()]
    assert all(one != other for one, other in combinations(bare, 2))


@TYPE
def test_the_modulus_of_a_type_has_a_known_origin(kind):
    """A word that nothing else checks at run time."""
    words = next(one.type for one in fields(SealType) if one.name == "modulus_by")
    assert repr(kind.modulus_by) in words


@LAW
def test_dry_friction_of_a_law(law):
    """Coulomb friction at rest, level and viscous part in motion, more with more load."""
    seal = sample(o_ring.TYPE, pressure=3e6)
    contact = o_ring.TYPE.contact(seal)
    coulomb = np.pi * 0.03 * 1000.0 * law.coefficient(seal, contact)
    found = law.friction(seal, contact, 1000.0, np.array([0.0, 0.2]))
    assert found.running[0] == pytest.approx(coulomb)
    assert found.running[1] == pytest.approx(law.level(seal, coulomb, 0.2) + 30.0 * 0.2)
    assert found.slope[1] == pytest.approx(law.slope(seal, coulomb, 0.2) + 30.0)
    assert (law.friction(seal, contact, 2000.0, 0.2).running > found.running[1]).all()


@LAW
def test_a_design_with_a_law_is_evaluated(law):
    """Finite friction; a film where the law has one, and only there."""
    line = block(o_ring.TYPE, friction=law.name)
    found = evaluated(block(o_ring.TYPE), line)
    assert all(0 < x < inf for x in found.metrics["friction_running"].by_case.values())
    assert (found.metrics["film_thickness"].value is not None) is (law.film is not None)
    counted = block(o_ring.TYPE, friction=law.name, count="2")
    if law.film is None:
        assert not ao.check(text(counted, block(o_ring.TYPE)))
    else:
        assert faults(counted)[0].path == "seals.piston.count"


@LAW
def test_a_film_without_a_solution_is_dry(law):
    """A law with a film states its dry friction for a seal at rest."""
    if law.film is None:
        return
    seal = sample(o_ring.TYPE, asperity_friction=0.2)
    contact = o_ring.TYPE.contact(seal)
    found = law.film(seal, contact, None)
    assert found.running == pytest.approx(np.pi * 0.03 * 0.2 * contact.line_load)
    assert found.slope == 0.0


# --- laws of contact and hardness -----------------------------------------------------------------


@pytest.mark.parametrize("law", CONTACT_LAWS.values(), ids=CONTACT_LAWS.names)
def test_limits_of_squeeze_hold_its_data(law):
    """A design may have any squeeze the law was compared on; outside its limits it is a fault."""
    low, high = law.squeeze_limits
    assert low <= law.squeeze_range[0] < law.squeeze_range[1] <= high
    widest = INPUTS["squeeze"]
    for value in (low - 0.01, high + 0.01):
        (fault,) = faults(block(o_ring.TYPE, law=law.name, squeeze=f"{100 * value:g} %"))
        of_law = f"outside the range of the contact law {law.name}" in fault.message
        assert of_law is (widest.lower <= value <= widest.upper)


@pytest.mark.parametrize("law", MODULUS_LAWS.values(), ids=MODULUS_LAWS.names)
def test_modulus_rises_with_hardness(law):
    """Over the whole range it covers."""
    hardness = np.linspace(*law.hardness_range, 30)
    modulus = law.modulus(hardness=hardness)
    assert (np.diff(modulus) > 0).all()
    assert modulus[0] > 0
