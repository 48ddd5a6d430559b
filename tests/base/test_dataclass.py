"""Fast data classes against those of the standard library."""

from __future__ import annotations

import copy
import dataclasses
import inspect
import itertools
import pickle
import sys
from dataclasses import field
from functools import partial
from typing import Any, ClassVar

import pytest

from actuator_opt.base.dataclass import FEW, dataclass

OPTIONS = [
    dict(zip(("frozen", "slots", "kw_only", "eq", "repr"), flags, strict=True))
    for flags in itertools.product((False, True), repeat=5)
]


def classes(decorator, **options):
    """A class, a subclass and a class with all kinds of fields, made by a decorator."""

    @decorator(**options)
    class Bar:
        length: float
        area: float = 2.0
        count: ClassVar[int] = 3

        def volume(self):
            return self.length * self.area

    @decorator(**options)
    class Tube(Bar):
        wall: float = 0.1
        area: float = 5.0

    @decorator(**options)
    class Record:
        name: str
        tags: list[str] = field(default_factory=list)
        secret: Any = field(default=None, repr=False, compare=False)
        total: int = field(init=False)
        fixed: int = field(init=False, default=7)
        last: int = field(default=1, kw_only=True)

        def __post_init__(self):
            object.__setattr__(self, "total", len(self.tags))

    return Bar, Tube, Record


def outcome(work):
    """Result of a call, or the kind of its exception with its text."""
    try:
        return work()
    except Exception as error:
        return type(error), str(error).replace("member 'length'", "length")


@pytest.mark.parametrize("options", OPTIONS, ids=lambda o: "-".join(k for k, v in o.items() if v))
@pytest.mark.parametrize("few", [0, 100], ids=["compiled", "first objects"])
def test_behaves_as_the_standard_decorator(monkeypatch, few, options):
    """Objects, fields, equality, hashes, texts, copies, frozen errors and signatures agree."""
    monkeypatch.setattr(sys.modules[dataclass.__module__], "FEW", few)
    results = []
    for decorator in (dataclasses.dataclass, dataclass):
        bar, tube, record = classes(decorator, **options)
        one, same = bar(length=3.0), bar(length=3.0)
        pipe = tube(length=1.0, wall=0.2)
        entry = record(name="a", tags=["x"], last=4)
        objects = (one, pipe, entry)
        results.append([
            [dataclasses.asdict(each) for each in objects],
            [[(f.name, f.init, f.kw_only) for f in dataclasses.fields(each)] for each in objects],
            [dataclasses.asdict(dataclasses.replace(one, area=9.0)), pipe.volume()],
            (one == same, one == pipe, one != 1, entry == dataclasses.replace(entry, secret=5)),
            outcome(lambda one=one, same=same: hash(one) == hash(same)) if options["eq"] else None,
            [repr(each) for each in objects] if options["repr"] else None,
            [str(inspect.signature(cls)).replace(" -> None", "") for cls in (bar, tube)],
            outcome(lambda one=one: setattr(one, "length", 4.0) or one.length),
            outcome(lambda one=one: setattr(one, "unknown", 4.0)) is not None
            if options["frozen"] else None,  # the standard one has a TypeError with slots
            (bar.__match_args__, tube.__match_args__, bar.count),
            dataclasses.asdict(copy.deepcopy(entry)),
            hasattr(one, "__dict__"),
        ])  # fmt: skip
    assert results[0] == results[1]


@dataclass(frozen=True, slots=True)
class Stored:
    """At module level, as pickle needs it."""

    length: float
    names: tuple[str, ...] = ()


def test_a_frozen_object_survives_pickle():
    """Its state is that of its fields."""
    stored = Stored(2.0, ("a",))
    assert pickle.loads(pickle.dumps(stored)) == stored


def test_wrong_arguments_are_named():
    """The message of a wrong call names class and argument, in the first call and later."""
    for _ in range(2):
        with pytest.raises(TypeError, match=r"Stored\.__init__\(\) missing 1 required .* 'length'"):
            Stored()
        with pytest.raises(TypeError, match="unexpected keyword argument 'width'"):
            Stored(length=1.0, width=2.0)


def test_a_mutable_default_is_refused():
    """As in the standard library."""
    with pytest.raises(ValueError, match="names: a mutable default"):

        @dataclass
        class Wrong:
            names: list[str] = []  # noqa: RUF012


def test_only_a_class_with_many_objects_is_compiled():
    """A class with few objects costs no compilation."""

    @dataclass(frozen=True)
    class Idle:
        length: float

    for number in range(FEW):
        assert Idle(number).length == number
    assert Idle.__init__.__name__ == "_first_init"
    assert Idle(1.0).length == 1.0
    assert Idle.__init__.__name__ == "__init__"


@pytest.mark.parametrize("few", [0, 100], ids=["compiled", "first objects"])
@pytest.mark.parametrize(
    "arguments",
    [
        ((), {}),
        ((1.0, 2.0, 3.0, 4.0), {}),
        ((1.0,), {"length": 2.0}),
        ((1.0,), {"width": 2.0}),
        ((1.0,), {"count": 2}),
    ],
)
def test_wrong_arguments_give_the_errors_of_the_standard_decorator(monkeypatch, few, arguments):
    """Missing, too many, twice, unknown, and no field."""
    monkeypatch.setattr(sys.modules[dataclass.__module__], "FEW", few)
    args, named = arguments
    bars = [classes(decorator)[0] for decorator in (dataclass, dataclasses.dataclass)]
    ours, standard = (outcome(partial(bar, *args, **named)) for bar in bars)
    assert ours[0] is TypeError
    assert ours == standard


def test_names_of_arguments_may_be_those_of_the_helpers():
    """A field named like an argument of our functions is set like any other."""

    @dataclass
    class Odd:
        cls: int
        args: int
        arguments: int = 3

    assert dataclasses.astuple(Odd(1, args=2)) == (1, 2, 3)
