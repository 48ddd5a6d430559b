"""The table of metrics: complete rows, views of it, and metrics that nothing computes."""

from pathlib import Path

import pytest

import actuator_opt as ao
from actuator_opt.evaluation.kernel import compute
from actuator_opt.evaluation.limits import MetricArrays, all_limits, default_limits
from actuator_opt.evaluation.validity import model_of
from actuator_opt.metrics import METRICS, table
from actuator_opt.metrics.documentation import function_of
from actuator_opt.metrics.metric_row import CRITERION, CheckLine, Least, MetricRow
from actuator_opt.metrics.table import ROWS

DESIGNS = sorted((Path(__file__).parents[2] / "designs").glob("*.yaml"))
MASS = ROWS["mass"]


def row(**changed):
    """A complete row, some of it changed; a value of ... leaves the field out."""
    stated = {"worst": "max", "model": None, "feeds": (), "check": None} | changed
    stated = {name: value for name, value in stated.items() if value is not ...}
    quantity = {"dimension": "length", "unit": "mm", "label": "span of the bearings"}
    return MetricRow(name="span", symbol="L", **quantity | stated)


@pytest.mark.parametrize("piece", ["worst", "model", "feeds", "check"])
def test_a_row_that_forgets_a_piece_is_refused(piece):
    """At import: the row cannot be made."""
    assert row().name == "span"
    with pytest.raises(TypeError, match=piece):
        row(**{piece: ...})


@pytest.mark.parametrize(
    ("changed", "words"),
    [
        ({"worst": "least"}, "worst value must be min or max"),
        ({"feeds": ("air",)}, "feeds must be one of wall, oil, own"),
        ({"least": Least(1e-3, "choice")}, "state `least`"),
        ({"label": ""}, "label is empty"),
        ({"dimension": "lenght"}, "no dimension lenght"),
        ({"unit": "mn"}, "mn"),
        ({"model": "gland"}, r"gland is not module\.function"),
    ],
)
def test_a_doubtful_row_is_refused(changed, words):
    """Misspelt words, and a least value of what is no geometry."""
    with pytest.raises(ValueError, match=words):
        row(**changed)


@pytest.mark.parametrize("name", ROWS)
def test_every_model_of_a_row_exists(name):
    """A misspelt module or function is found here."""
    own = ROWS[name]
    for model in {own.model, *own.by_wall.values(), *own.at.values()} - {None, CRITERION}:
        assert callable(function_of(model))


def test_a_limit_without_source_is_refused():
    """A check states both or neither."""
    with pytest.raises(ValueError, match="limit and source, or neither"):
        CheckLine("1.9", "span", 0.1)
    with pytest.raises(ValueError, match="limit and source, or neither"):
        CheckLine("1.9", "span", source="practice")


def test_doubled_rows_and_checks_are_refused():
    """Two metrics of a name, two lines of a number."""
    with pytest.raises(ValueError, match="metric mass: duplicate name"):
        table.table([MASS, MASS])
    other = row(check=CheckLine(MASS.check.number, "span"))
    with pytest.raises(ValueError, match=r"check 13\.1: used by mass and span"):
        table.table([MASS, other])


def test_an_undeclared_metric_cannot_be_computed():
    """The message says where its row belongs."""
    with pytest.raises(KeyError, match=r"metric span: add its row to metrics/table\.py"):
        MetricArrays().put("span", 1.0)


QUICK = [file for file in DESIGNS if file.stem != "huang_110_80_560"]  # its films take seconds


@pytest.mark.parametrize("file", QUICK, ids=lambda file: file.stem)
def test_every_metric_is_computed_or_says_why_not(file):
    """A row that nothing computes is found in every design."""
    actuator = ao.read(file)
    subject = actuator.subject()
    done = compute(subject, subject.values()).computed
    silent = METRICS.keys() - done.metrics.keys() - done.why.keys()
    assert not silent


def test_the_views_hold_every_row():
    """Check list in the order of its numbers, limits and warnings, all from the rows."""
    lines = [row for row in ROWS.values() if row.check is not None]
    assert len(table.CHECKS) == len(lines) > 50
    orders = [check.order for _, check in table.CHECKS]
    assert orders == sorted(set(orders))
    design = ao.read(DESIGNS[0]).design
    limits = {limit.metric for limit in all_limits(design) if limit.origin == "geometry"}
    assert limits == {name for name in METRICS if name.startswith("geometry_")}
    assert default_limits()["requirements.burst_factor.min"] == ROWS["burst_factor"].check.limit
    assert {"bore_growth", "burst_factor"} <= {*table.WALL_FED} & table.OWN
    assert "stiffness_oil" in table.OIL_FED


def test_models_by_wall_place_and_criterion():
    """The most particular statement of a row decides."""

    def name(metric, **at):
        return model_of(metric, **({"wall": "isotropic"} | at)).name

    assert name("burst_factor") == "barrel.burst_pressure_thick"
    assert name("burst_factor", wall="layered") == "tube_burst.burst_of_tube"
    assert name("yield_factor", wall="layered", place="rod") == "column.amplified_moment"
    assert name("rod_factor", criterion="max_stress") == "strength_modes.max_stress_modes"
    assert name("rod_factor", place="rod, yield, layer 1") == "strength.yield_utilisation"
    assert model_of("closed_length", wall="layered") is None
    assert model_of("a user's own", wall="layered") is None
