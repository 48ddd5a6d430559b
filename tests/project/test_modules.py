"""Claims about the package as a whole: no circle of imports, no model that nobody can reach."""

from __future__ import annotations

import ast
import re
from pathlib import Path

import pytest
from cases.sources import parsed
from model_samples import public_functions

import actuator_opt
import actuator_opt.api
import actuator_opt.models

ROOT = Path(__file__).parents[2]
SCRIPTS = [*ROOT.glob("designs/scripts/*.py"), *ROOT.glob("reports/*.py")]
FUNCTIONS = (ast.FunctionDef, ast.AsyncFunctionDef, ast.Lambda)


def modules():
    """Syntax tree of every module of the package, by its dotted name."""
    found = {}
    for path in sorted((ROOT / "actuator_opt").rglob("*.py")):
        parts = path.relative_to(ROOT).with_suffix("").parts
        name = ".".join(parts[:-1] if parts[-1] == "__init__" else parts)
        found[name] = (parsed(path)[1], path.name == "__init__.py")
    return found


def imported(nodes, name, package, *, functions):
    """Pairs (module, name or None) of every import statement; inside functions if asked for."""
    for node in nodes:
        if isinstance(node, ast.Import):
            yield from ((alias.name, None, alias.asname) for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            base = name.split(".")[: len(name.split(".")) + package - node.level]
            source = ".".join([*(base if node.level else []), *filter(None, [node.module])])
            yield from ((source, alias.name, alias.asname) for alias in node.names)
        elif functions or not isinstance(node, FUNCTIONS):
            children = ast.iter_child_nodes(node)
            yield from imported(children, name, package, functions=functions)


def imports_of(trees):
    """Modules that each module imports at module level, under TYPE_CHECKING too."""
    graph = {}
    for name, (tree, package) in trees.items():
        targets = {
            f"{source}.{what}" if f"{source}.{what}" in trees else source
            for source, what, _ in imported(tree.body, name, package, functions=False)
        }
        graph[name] = (targets & set(trees)) - {name}
    return graph


def in_circles(graph):
    """Modules that import themselves through others: those left when ends are taken away."""
    left = dict(graph)
    while True:
        needed = set().union(*left.values())
        ends = {name for name in left if name not in needed or not left[name] & set(left)}
        if not ends:
            return sorted(left)
        left = {name: found - ends for name, found in left.items() if name not in ends}


def test_no_circle_of_imports():
    """No module imports itself through others at module level, for types alone either."""
    assert in_circles(imports_of(modules())) == []


def test_a_circle_for_types_is_seen():
    """A module that another needs only under TYPE_CHECKING closes the circle."""
    sources = {
        "p": ("from .a import f", True),
        "p.a": ("from . import b\ndef f(): return b", False),
        "p.b": ("from typing import TYPE_CHECKING\nif TYPE_CHECKING:\n    from .a import f", False),
        "p.c": ("def g():\n    from .d import h", False),
        "p.d": ("from .c import g", False),
    }
    trees = {name: (ast.parse(text), package) for name, (text, package) in sources.items()}
    assert in_circles(imports_of(trees)) == ["p.a", "p.b"]


def local_names(part):
    """Arguments and variables of a function, inner ones included."""
    names = {node.arg for node in ast.walk(part) if isinstance(node, ast.arg)}
    stored = (node for node in ast.walk(part) if isinstance(node, ast.Name))
    return names | {node.id for node in stored if isinstance(node.ctx, ast.Store)}


def models_used(tree, name, package):
    """Model functions that a module calls, or the table of metrics names: ``module.function``."""
    home = name.removeprefix("actuator_opt.models.")
    models, direct = {}, {}
    if home != name:
        direct = {part.name: f"{home}.{part.name}" for part in tree.body if hasattr(part, "name")}
    for source, what, alias in imported(tree.body, name, package, functions=True):
        if source == "actuator_opt.models" and what:
            models[alias or what] = what
        elif source.startswith("actuator_opt.models.") and what:
            direct[alias or what] = f"{source.rpartition('.')[2]}.{what}"
    for part in tree.body:
        hidden = {getattr(part, "name", None)}
        hidden |= local_names(part) if isinstance(part, FUNCTIONS) else set()
        for node in ast.walk(part):
            if isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name):
                yield f"{models.get(node.value.id)}.{node.attr}"
            elif isinstance(node, ast.Name) and node.id in direct and node.id not in hidden:
                yield direct[node.id]
            elif isinstance(node, ast.Constant) and name.startswith("actuator_opt.metrics"):
                yield str(node.value)


def test_every_model_is_used_or_listed_for_scripts():
    """Code calls it, or the head of `actuator_opt.models` names it as one for scripts; not both."""
    trees = {**modules(), **{p.stem: (ast.parse(p.read_text("utf-8")), False) for p in SCRIPTS}}
    used = {
        model
        for name, (tree, package) in trees.items()
        for model in models_used(tree, name, package)
    }
    _, for_scripts = actuator_opt.models.__doc__.split("for scripts alone")
    listed = set(re.findall(r"`(\w+\.\w+)`", for_scripts)) - {"stops.cushion"}
    assert set(public_functions()) - used == listed


@pytest.mark.parametrize("package", [actuator_opt, actuator_opt.api], ids=lambda x: x.__name__)
def test_public_names_load_and_are_known_to_type_checkers(package):
    """Each loads; the imports for type checkers name the same from the same modules."""
    tree = ast.parse(Path(package.__file__).read_text("utf-8"))
    typed = next(node for node in tree.body if isinstance(node, ast.If))
    static = {
        alias.asname: "." * (node.level - 1) + node.module
        for node in typed.body
        for alias in node.names
    }
    assert static == package._HOMES
    assert {*package.__all__} - {"__version__"} == set(static)
    assert dir(package) == sorted(package.__all__)
    assert all(getattr(package, name) is not None for name in package.__all__)
    with pytest.raises(AttributeError, match="no attribute 'evaluat'"):
        package.evaluat  # noqa: B018


def test_commands_use_exported_names_alone():
    """Each `verbs.NAME` of the command line is exported by `api`."""
    used = {
        node.attr
        for name, (tree, _) in modules().items()
        if name.startswith("actuator_opt.cli")
        for node in ast.walk(tree)
        if isinstance(node, ast.Attribute)
        and isinstance(node.value, ast.Name)
        and node.value.id == "verbs"
    }
    assert len(used) > 20
    assert used <= set(actuator_opt.api.__all__)
