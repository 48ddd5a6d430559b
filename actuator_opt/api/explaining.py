"""Explains a name: what it is, how to ask for it, what moves it, where its number comes from."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Unpack, get_args

from ..base.arguments import SetValues, guarded
from ..base.dataclass import dataclass
from ..base.quantities import INFINITY, MATERIAL_PROPERTIES, Quantity, short
from ..base.tables import Displayed
from .reference import Entry, actuator_of, checked_word, find, unknown, used_at, word_of

if TYPE_CHECKING:
    from ..design.model import Design
    from ..evaluation import Evaluation
    from ..metrics.documentation import ModelDocumentation
    from ..metrics.metric_row import MetricRow
    from ..rendering.console import Style
    from .actuator import Actuator, Plugins, Result

MOST_MOVERS = 5
"""Largest number of influences listed."""


@dataclass(frozen=True, slots=True)
class Explanation(Displayed):
    """Meaning of a name, lines that ask for it, and source of its number.

    Parameters
    ----------
    entry : the name
    definition : what it is, in sentences
    ask : lines to copy into a design file or a command
    model, source, validity : model function behind it, source, and valid range
    related : names to look up next
    value : its value in the design in words; "" without a design
    influences : numbers that move a metric, or metrics that a number moves, in % per %
    """

    entry: Entry
    definition: str
    ask: tuple[str, ...] = ()
    model: str = ""
    source: str = ""
    validity: str = ""
    related: tuple[str, ...] = ()
    value: str = ""
    influences: Mapping[str, float] = field(default_factory=dict)

    @property
    def in_short(self) -> tuple[str, str]:
        """The name, and what it means."""
        return self.entry.name, f"{self.entry.kind}, {self.entry.phrase}"

    def to_dict(self) -> dict[str, Any]:
        """Plain data for JSON, SI."""
        moves = [{"name": name, "percent_per_percent": x} for name, x in self.influences.items()]
        return self.entry.to_dict() | {
            "symbol": self.entry.quantity.symbol if self.entry.quantity else None,
            "definition": self.definition,
            "in_design": self.value or None,
            "ask": list(self.ask),
            "influences": moves,
            "model": self.model or None,
            "source": self.source or None,
            "validity": self.validity or None,
            "related": list(self.related),
        }

    def text(self, **style: Unpack[Style]) -> str:
        """Terminal text of at most one screen."""
        from ..pages.reference import Part, explanation
        from ..rendering.terminal import blocks_text

        parts: dict[Part, str] = {
            "what": self.definition,
            "now": self.value,
            "model": self.model,
            "valid": self.validity,
            "source": self.source,
            "see": ", ".join(self.related),
        }
        entry = self.entry
        table = explanation(
            entry.name, entry.kind, entry.quantity, parts, self.ask, self.influences
        )
        return blocks_text([table], **style)


@guarded
def explain(
    word: str,
    design: Actuator | Design | Result | str | Path | None = None,
    *,
    set: SetValues = (),
    plugins: Plugins = (),
) -> Explanation:
    """Explain a name: what it is, how to ask for it, what moves it, and where it comes from.

    Parameters
    ----------
    word : PATH, block, metric, check (its number or title), material, material property, joint,
        seal type, friction law, or term such as "margin"
    design : design whose value and influences are stated; None for the name alone
    set, plugins : changed values and user metrics of the design, as for `read`

    Raises
    ------
    UsageError : unknown word (with the nearest names), or a word that cannot be a name
    InputError : the design has faults

    >>> explain("stiffness_min").entry.unit
    'kN/mm'
    """
    text = checked_word(word)
    if design is None:
        entry = find(text)
        if entry is None:
            raise unknown(text)
        return _EXPLAIN[entry.kind](entry, None)
    from ..evaluation.plugin import with_own

    actuator = actuator_of(design, set, plugins)
    entry = find(text, with_own(actuator.plugins))
    if entry is None:
        raise unknown(text)
    return _EXPLAIN[entry.kind](entry, actuator)


def _documented(name: str) -> ModelDocumentation:
    from ..metrics.documentation import describe, function_of

    return describe(function_of(name))


def _top(values: Mapping[str, float]) -> dict[str, float]:
    return dict(list(values.items())[:MOST_MOVERS])


def _limit_lines(name: str, quantity: Quantity, limits: Mapping[str, float]) -> tuple[str, ...]:
    """Lines that ask for limits (SI) of a metric, in a file and on the command line."""
    texts = {side: quantity.text(value, 6) for side, value in limits.items()}
    inside = ", ".join(f"{side}: {text}" for side, text in texts.items())
    return (
        f"requirements: {{{name}: {{{inside}}}}}",
        *(f'--set "requirements.{name}.{side}={text}"' for side, text in texts.items()),
    )


def _asked(entry: Entry, value: float | None, actuator: Actuator | None) -> tuple[str, ...]:
    """Lines that make a metric a requirement or the objective."""
    from ..metrics.table import ROWS

    quantity, row = entry.quantity, ROWS.get(entry.name)
    assert quantity is not None
    side = quantity.worst or "max"
    stated = None if actuator is None else actuator.design.requirements.get(entry.name)
    limits = {s: x for s in ("min", "max") if (x := getattr(stated, s, None)) is not None}
    if not limits:
        usual = None if row is None or row.check is None else row.check.limit
        one = _unit_or_one(quantity)
        known = next(x for x in (value, usual, one) if x is not None)
        limits = {side: known if abs(known) < INFINITY else one}
    verb = "maximise" if side == "min" else "minimise"
    return (*_limit_lines(entry.name, quantity, limits), f"objective: {{{verb}: {entry.name}}}")


def _governed(entry: Entry, evaluation: Evaluation) -> str:
    """Value of a metric in words: where it governs, and the limits on it."""
    metric = evaluation.metrics[entry.name]
    if metric.value is None:
        return f"none: {metric.why}"
    where = ", ".join(x for x in (metric.case, metric.place) if x)
    text = replace(entry, value=metric.value).text + (f" ({where})" if where else "")
    quantity = metric.quantity
    for row in evaluation.requirements:
        if row.metric == entry.name:
            sign = ">=" if row.sense == "min" else "<="
            word = "met" if row.met else "missed"
            margin = "" if row.margin is None else f", margin {100 * row.margin:.3g} %"
            text += f"; required {sign} {quantity.text(row.limit)}: {word}{margin}"
    return text


def _moved_by(name: str, actuator: Actuator) -> dict[str, float]:
    """Numbers of the design with the largest influence on a metric."""
    from ..evaluation.influences import influences, influential_numbers

    subject = actuator.subject()
    return _top(influences(subject, [name], influential_numbers(subject))[name])


def _of_metric(entry: Entry, actuator: Actuator | None) -> Explanation:
    from ..metrics.metric_row import CRITERION
    from ..metrics.table import ROWS

    row = ROWS.get(entry.name)
    value, now, movers, extreme = None, "", {}, ""
    if entry.quantity is not None and entry.quantity.worst:
        extreme = "smallest" if entry.quantity.worst == "min" else "largest"
    definition = f"{entry.phrase}; the {extreme} value of all load cases and places governs"
    model, source, validity = "your own function", "plug-in", ""
    related: list[str] = []
    if row is not None:
        model, source = "none: from the dimensions alone", "[derived] geometry"
        names = dict.fromkeys(filter(None, (row.model, *row.by_wall.values())))
        if row.least is not None:
            source = f"limit: {row.least.source}"
        if documented := [_documented(name) for name in names if name != CRITERION]:
            model = ", ".join(_by_wall(row, names))
            definition = f"{entry.phrase}: {documented[0].summary}"
            source = "; ".join(dict.fromkeys(d.reference for d in documented))
            validity = documented[0].valid.removesuffix(".")
        if row.check is not None:
            related.append(f"check {row.check.number}")
        related += _akin(entry.name)
    if actuator is not None:
        from .optimum import evaluate

        evaluation = evaluate(actuator)
        metric = evaluation.metrics[entry.name]
        value, now = metric.value, _governed(entry, evaluation)
        model, source = metric.model or model, metric.reference or source
        validity += "" if metric.in_range else "; outside it here"
        movers = _moved_by(entry.name, actuator) if value is not None else {}
    return Explanation(
        replace(entry, value=value), definition, _asked(entry, value, actuator), model, source,
        validity, tuple(related), now, movers,
    )  # fmt: skip


def _by_wall(row: MetricRow, names: Iterable[str]) -> Iterator[str]:
    """The models of a metric, each with the wall models (`barrel.model`) for which it applies."""
    from ..metrics.metric_row import CRITERION, Wall

    walls: dict[str, str | None] = {"isotropic": row.model}
    walls |= {wall: row.by_wall.get(wall, row.model) for wall in get_args(Wall)}
    head = "barrel.model "
    for name in names:
        words = "failure criterion of barrel.criterion" if name == CRITERION else name
        where = " or ".join(wall for wall, model in walls.items() if model == name)
        yield f"{words} ({head}{where})" if row.by_wall else words
        head = ""


def _akin(name: str) -> list[str]:
    """Metrics that begin with the same word or come from the same model."""
    from ..metrics.table import ROWS

    first, model = name.split("_")[0], ROWS[name].model
    akin = [
        other
        for other, row in ROWS.items()
        if other != name
        and (other.split("_")[0] == first or (model is not None and row.model == model))
    ]
    return akin[:4]


def _of_check(entry: Entry, actuator: Actuator | None) -> Explanation:
    from ..metrics.table import CHECKS

    row, line = next(pair for pair in CHECKS if pair[1].number == entry.name)
    metric = _of_metric(Entry(row.name, "metric", row.label, row.quantity), None)
    sign = ">=" if row.worst == "min" else "<="
    limit = (
        f"{sign} {row.quantity.text(line.limit)} ({line.source})"
        if line.limit is not None
        else "only a limit that the design file requires"
    )
    advice = "; advice: it warns, but does not hold the optimiser" if line.advice else ""
    definition = f"{line.name}: {row.name}, {limit}{advice}"
    ask = metric.ask[:1]
    if line.limit is not None:
        ask = _limit_lines(row.name, row.quantity, {row.worst: line.limit})[:1]
    now, value, movers = "", None, {}
    if actuator is not None:
        from .optimum import evaluate

        check = next(c for c in evaluate(actuator).checks if c.name == line.name)
        value, now = check.value, check.status.replace("_", " ")
        if check.value is not None and check.limit is not None:
            side = ">=" if check.sense == "min" else "<="
            where = ", ".join(x for x in (check.case, check.place) if x)
            now = f"{row.quantity.text(check.value)} {side} {row.quantity.text(check.limit)}: {now}"
            now += f" ({where})" if where else ""
        elif check.reason:
            now += f": {check.reason}"
        movers = _moved_by(row.name, actuator) if value is not None else {}
    return Explanation(
        replace(entry, value=value), definition,
        (*ask, f"waivers: {{{row.name}: reason why it does not apply}}"), metric.model,
        f"limit: {line.source}; {metric.source}" if line.source else metric.source,
        metric.validity, (row.name, "check", "waiver"), now, movers,
    )  # fmt: skip


def _of_path(entry: Entry, actuator: Actuator | None) -> Explanation:
    from ..design.kinds import MaterialName, Of
    from ..design.structure import templates

    generic = re.sub(r"\[[^\[\]]*\]", "[*]", entry.name)
    key = templates().get(generic)
    definition, sample = entry.phrase, ""
    choices: tuple[str, ...] = ()
    if key is not None:
        if key.kind is not None and not isinstance(key.kind, MaterialName):
            definition = key.kind.help or entry.phrase
        choices = key.choices
        if not key.required and key.default is not None and not isinstance(key.default, tuple):
            definition += f"; default: {value_text(key.quantity(), key.default)}"
        sample = choices[0] if choices else (key.kind.example if key.kind is not None else "")
        block = generic.rpartition(".")[0]
        siblings = [path for path in templates() if path.rpartition(".")[0] == block]
        related = [block, *[path for path in siblings if path != generic][:3]]
        if isinstance(key.kind, MaterialName):
            definition += f", such as {sample}"
            related.append("actuator-opt list materials")
    else:
        sample = "" if entry.quantity is None else _sample_limit(entry, actuator)
        related = [entry.name.rpartition(".")[0].partition(".")[2]]
    validity = "" if entry.quantity is None else range_of(entry.quantity)
    path = entry.name.replace("[*]", "[0]")
    now, value = "", None
    moves: Mapping[str, float] = {}
    if actuator is not None:
        now, value, moves = _in_design(entry, actuator)
        path = entry.name if "[*]" not in entry.name else path
        if isinstance(value, float) and entry.quantity is not None:
            sample = entry.quantity.text(value, 6)
        elif isinstance(value, str) and not choices:
            sample = value
    ask = [f'--set "{path}={sample}"']
    if choices:
        ask.append(f"choices: {{{_quoted(path)}: [{', '.join(choices[:4])}]}}")
    elif key is not None and isinstance(key.kind, Of) and entry.quantity is not None:
        ask += _variable_lines(path, entry.quantity, value, sample, actuator)
    return Explanation(
        replace(entry, value=value), definition, tuple(ask), "", "", validity, tuple(related), now,
        moves,
    )  # fmt: skip


def _sample_limit(entry: Entry, actuator: Actuator | None) -> str:
    """A value for a PATH of a table: the present one of its metric, or one unit."""
    assert entry.quantity is not None
    head, _, rest = entry.name.partition(".")
    if actuator is not None and head == "requirements":
        from .optimum import evaluate

        metric = evaluate(actuator).metrics[rest.rpartition(".")[0]]
        if metric.value is not None:
            return entry.quantity.text(metric.value)
    return entry.quantity.text(_unit_or_one(entry.quantity))


def _unit_or_one(quantity: Quantity) -> float:
    """One display unit of a quantity, SI; 1 without a unit."""
    from ..base.units import unit

    return unit(quantity.unit, quantity.dimension).to_si(1.0) if quantity.unit else 1.0


def range_of(quantity: Quantity) -> str:
    """Valid range of a quantity in words; "" if it has none."""
    if quantity.lower == -INFINITY and quantity.upper == INFINITY:
        return ""
    if quantity.upper == INFINITY:
        return f"at least {quantity.text(quantity.lower, 7)}"
    return quantity.range_text()


def value_text(quantity: Quantity | None, value: object) -> str:
    """A default value in words."""
    from ..design.structure import number_of

    number = number_of(value)
    return word_of(value) if quantity is None or number is None else quantity.text(number, 6)


def _quoted(path: str) -> str:
    """A PATH as a key inside braces, where YAML takes a bracket as the start of a list."""
    return f'"{path}"' if "[" in path else path


def _variable_lines(
    path: str, quantity: Quantity, value: object, sample: str, actuator: Actuator | None
) -> list[str]:
    """Lines that free a number for `optimise`, and vary it in a `sweep`."""
    from ..base import units

    if quantity.dimension == "count":
        return [f'sweep --vary "{path}={sample}"']
    bounds = None if actuator is None else actuator.design.variables.get(path)
    if bounds is not None:
        low, high = bounds.lower, bounds.upper
    else:
        middle = value if isinstance(value, float) else units.parse(sample, quantity.dimension)
        spread = 0.2 * abs(middle) if quantity.dimension != "temperature" else 10.0
        low = max(middle - spread, quantity.lower)
        high = min(middle + spread, quantity.upper)
    ends = quantity.text(low, 4), quantity.text(high, 4)
    number = short(quantity.to_display(low), 4)
    return [
        f"variables: {{{_quoted(path)}: {{lower: {ends[0]}, upper: {ends[1]}}}}}",
        f'sweep --vary "{path}={number}..{ends[1]}:5"',
    ]


def _in_design(
    entry: Entry, actuator: Actuator
) -> tuple[str, float | str | None, dict[str, float]]:
    """Value at a PATH in words and as data, and the metrics that it moves most."""
    from ..design.paths import get, numbers, resolve, spell
    from ..design.structure import leaves, value_at

    design = actuator.design
    if "[*]" in entry.name:
        pattern = entry.name
        stated = [
            f"{spell(loc, design)} {value_text(key.quantity(value), value)}"
            for loc, key, value in leaves(design)
            if re.sub(r"\[\d+\]", "[*]", spell(loc)) == pattern
        ]
        return ", ".join(stated) or "not stated", None, {}
    path = resolve(entry.name, design).path
    value = get(design, path)
    if value is None:
        default = value_at(design, resolve(path, design).loc)
        text = "not stated" if default is None else f"not stated; {word_of(default)}"
        return text, None, {}
    known = numbers(design)
    if not isinstance(value, float) and path not in known:
        return word_of(value), word_of(value), {}
    number = known.get(path, value)
    text = value_text(entry.quantity, number)
    bounds = design.variables.get(path)
    if bounds is not None and entry.quantity is not None:
        low, high = (entry.quantity.text(x, 6) for x in (bounds.lower, bounds.upper))
        text += f"; a variable from {low} to {high}"
    return text, float(number), _moves(path, actuator)


def _moves(path: str, actuator: Actuator) -> dict[str, float]:
    """Metrics of the objective and the requirements that a number moves, the most moved first."""
    from ..evaluation.influences import influences, influential_numbers

    subject, design = actuator.subject(), actuator.design
    if path not in influential_numbers(subject):
        return {}
    metrics = dict.fromkeys((*design.objective.metrics, *design.requirements))
    moved = influences(subject, metrics, [path])
    values = {metric: value[path] for metric, value in moved.items() if path in value}
    return _top(dict(sorted(values.items(), key=lambda pair: -abs(pair[1]))))


def _of_block(entry: Entry, actuator: Actuator | None) -> Explanation:
    from ..design.structure import blocks, child_at, entries

    key = blocks()[entry.name]
    names: list[str] = []
    if key.section is not None:
        required = [name for name, below in entries(key.section).items() if below.required]
        names = [*required, *(n for n in entries(key.section) if n not in required)]
    definition = entry.phrase
    if key.section is not None and key.shape != "table":
        definition += f" Keys: {', '.join(names)}."
    now = ""
    if actuator is not None:
        stated = child_at(actuator.design, tuple(entry.name.replace("[*]", ".0").split(".")))
        count = len(stated) if isinstance(stated, (tuple, Mapping)) else None
        now = "not stated" if stated is None or count == 0 else "stated"
        now = f"{count} entries" if count else now
    inner = f"{entry.name}.{names[0]}" if names and key.shape == "section" else ""
    return Explanation(
        entry, definition, (f"actuator-opt list paths {entry.name.replace('[*]', '')}",),
        related=(inner,) if inner else ("PATH",), value=now,
    )  # fmt: skip


def _of_material(entry: Entry, actuator: Actuator | None) -> Explanation:
    from ..design.materials import load_library

    material = load_library().get(entry.name)
    listed = [
        f"{name} {entry_.text}" + ("" if entry_.confidence == "verified" else "*")
        for name, entry_ in material.properties.items()
        if entry_.basis not in ("nominal", "limit")
    ][:8]
    definition = f"{material.label} ({material.kind}): {', '.join(listed)}"
    if any("*" in text for text in listed):
        definition += " (* not verified)"
    sources = dict.fromkeys(p.source for p in material.properties.values())
    numbers = material.numbers
    ends = [numbers.get(f"temperature_{end}") for end in ("min", "max")]
    temperature = MATERIAL_PROPERTIES["temperature_min"]
    validity = (
        f"{temperature.text(ends[0])} to {temperature.text(ends[1])}"
        if ends[0] is not None and ends[1] is not None
        else ""
    )
    places = _places_for(material.kind)
    used = [] if actuator is None else used_at(entry, actuator.design)
    now = "" if actuator is None else (f"used at {', '.join(used)}" if used else "not used")
    example = next(iter(material.properties))
    ask = (
        *(f'--set "{path}={entry.name}"' for path in (used or places)[:1]),
        f'--set "materials.{entry.name}.{example}={material.properties[example].text}"',
        f"actuator-opt materials show {entry.name}",
    )
    related = (*places[1:4], material.notes and "actuator-opt materials compare")
    return Explanation(
        entry, definition, ask, "library value", "; ".join(sources), validity,
        tuple(filter(None, related)), now,
    )  # fmt: skip


def _places_for(kind: str) -> list[str]:
    """PATHs that take a material of a kind, the most usual first."""
    from ..design.kinds import MaterialName
    from ..design.material import ROLES
    from ..design.structure import templates

    ranks = []
    for path, key in templates().items():
        if isinstance(key.kind, MaterialName):
            offered = key.kind.usual or ROLES[key.kind.role]
            if kind in offered:
                ranks.append((offered.index(kind), path.count("."), path.replace("[*]", "[0]")))
    return [path for _, _, path in sorted(ranks, key=lambda rank: rank[:2])]


def _of_property(entry: Entry, actuator: Actuator | None) -> Explanation:
    from ..design.materials import load_library

    assert entry.quantity is not None
    now, materials = "", {material.name: material for material in load_library()}
    if actuator is not None:
        used = actuator.subject().materials
        texts = [
            f"{name} {material.properties[entry.name].text}"
            for name, material in used.items()
            if entry.name in material.properties
        ]
        now = ", ".join(texts) or "no material of this design states it"
        materials = {**used, **materials}
    stating = [m for m in materials.values() if entry.name in m.properties]
    first, text = "NAME", entry.quantity.text(_unit_or_one(entry.quantity))
    if stating:
        first, text = stating[0].name, stating[0].properties[entry.name].text
    examples = ", ".join(m.name for m in stating[:3])
    definition = f"{entry.phrase}; " + (
        f"a property of materials such as {examples}" if stating else "no library material has it"
    )
    return Explanation(
        entry, definition, (f'--set "materials.{first}.{entry.name}={text}"',), "library value",
        "stated with each material: actuator-opt materials show NAME", range_of(entry.quantity),
        ("confidence", "scatter", "knock-down"), now,
    )  # fmt: skip


def _where(entry: Entry, actuator: Actuator | None) -> str:
    """Where a design uses a joint, seal type or law, in words; "" without a design."""
    if actuator is None:
        return ""
    used = used_at(entry, actuator.design)
    return f"used at {', '.join(used)}" if used else "not used"


def _of_joint(entry: Entry, actuator: Actuator | None) -> Explanation:
    from ..design.model import EndRetention
    from ..design.structure import entries
    from ..joints.kinds import JOINTS

    joint = JOINTS[entry.name]
    keys = entries(EndRetention)
    needed = ["length", *(field.key for field in joint.fields if field.missing)]
    stated = [f"type: {joint.name}"]
    for name in dict.fromkeys(key.partition(".")[0] for key in needed):
        key = keys[name]
        text = key.kind.example if key.kind is not None else ""
        if key.section is not None:
            below = entries(key.section).items()
            inner = [f"{n}: {e.kind.example}" for n, e in below if e.required and e.kind]
            text = f"{{{', '.join(inner)}}}"
        if name == "material" and "metal" in joint.kinds and "adhesive" not in joint.kinds:
            text = "steel_42crmo4"
        stated.append(f"{name}: {text}")
    documented = [_documented(name) for name in dict.fromkeys(joint.models.values())]
    others = [f.key for f in joint.fields if f.key not in needed]
    definition = f"{entry.phrase}; judged on {joint.judged[0]}, at burst on {joint.judged[1]}"
    if others:
        definition += f"; further keys: {', '.join(others)}"
    metrics = dict.fromkeys(metric for metric, _ in joint.models)
    return Explanation(
        entry, definition,
        (f"retention: {{{', '.join(stated)}}}", f'--set "retention.type={joint.name}"'),
        ", ".join(d.name for d in documented),
        "; ".join(dict.fromkeys(d.reference for d in documented)), documented[0].valid,
        (*metrics, *joint.metrics), _where(entry, actuator),
    )  # fmt: skip


def _of_seal(entry: Entry, actuator: Actuator | None) -> Explanation:
    from ..metrics.documentation import describe
    from ..models.seals import LAWS
    from ..seals.kinds import TYPES

    kind, law = TYPES[entry.name], LAWS["energised"]
    model, source = f"contact law {law.name} (seals.piston.law)", law.reference
    validity = (
        f"squeeze {100 * law.squeeze_range[0]:g} to {100 * law.squeeze_range[1]:g} %, pressure up "
        f"to {law.pressure_range[1]:g} times Young's modulus"
    )
    if kind.model is not None:
        documented = describe(kind.model)
        model, source, validity = documented.name, documented.reference, documented.valid
    compound = "ptfe_bronze_nbr_70" if kind.modulus_by == "hardness" else "nbr_90"
    sizes = {f.key: f.size.example for f in kind.fields if f.default is None}
    stated = {"type": kind.name, "compound": compound, "section": "3.53 mm", "squeeze": "12 %"}
    inside = ", ".join(f"{key}: {text}" for key, text in (stated | sizes).items())
    optional = [f.key for f in kind.fields if f.default is not None]
    definition = f"{kind.title}: {entry.phrase}"
    definition += f"; optional sizes: {', '.join(optional)}" if optional else ""
    return Explanation(
        entry, definition,
        (f"seals: {{piston: {{{inside}}}}}", f'--set "seals.piston.type={kind.name}"'),
        model, source, validity,
        ("friction_running", "seal_squeeze", "seal_gap", "seals.piston.friction"),
        _where(entry, actuator),
    )  # fmt: skip


def _of_law(entry: Entry, actuator: Actuator | None) -> Explanation:
    from ..friction.kinds import LAWS
    from ..metrics.documentation import describe

    law = LAWS[entry.name]
    documented = describe(law.model)
    definition = entry.phrase
    if law.compound:
        definition += f"; the compound must state {', '.join(law.compound)}"
    ask = tuple(f'--set "seals.{place}.friction={law.name}"' for place in ("piston", "rod"))
    return Explanation(
        entry, definition, ask, documented.name, documented.reference, documented.valid,
        ("friction_running", "friction_breakaway", "Stribeck curve"), _where(entry, actuator),
    )  # fmt: skip


def _of_term(entry: Entry, actuator: Actuator | None) -> Explanation:
    from .glossary import terms

    term = terms()[entry.name]
    return Explanation(entry, term.definition, source=term.source, related=term.related)


_EXPLAIN: Mapping[str, Callable[[Entry, Any], Explanation]] = {
    "metric": _of_metric,
    "check": _of_check,
    "PATH": _of_path,
    "block": _of_block,
    "material": _of_material,
    "material property": _of_property,
    "joint": _of_joint,
    "seal type": _of_seal,
    "friction law": _of_law,
    "term": _of_term,
}
"""For each kind of name, the function that explains it."""


def explained(entry: Entry) -> Explanation:
    """Explanation of an entry, without a design."""
    return _EXPLAIN[entry.kind](entry, None)
