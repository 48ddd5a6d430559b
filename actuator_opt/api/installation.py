"""`doctor`: checks the state of this installation."""

from __future__ import annotations

import os
import platform
import re
import sys
import tomllib
from collections.abc import Iterator, Sequence
from dataclasses import asdict
from importlib import import_module, metadata
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, TypeAlias, Unpack

from ..base import files as store
from ..base.arguments import guarded
from ..base.dataclass import dataclass
from ..base.errors import InputError
from ..base.tables import Displayed
from ..version import VERSION

if TYPE_CHECKING:
    from ..rendering.console import Style

Status: TypeAlias = Literal["ok", "missing", "fault"]
"""State of an item. "ok": as required. "missing": an optional package is not installed. "fault":
some commands will fail."""

_NAME = "actuator-opt"
_OLDEST = (3, 11)
_FONTS = ("DejaVuSans.ttf", "DejaVuSans-Bold.ttf", "DejaVuSansMono.ttf")
"""Fonts used in pages and figures; matplotlib includes them."""
_REQUIREMENT = re.compile(r"([A-Za-z0-9][\w.-]*)\s*(\[[^\]]*\])?\s*([^;]*)")
_EXTRA = re.compile(r"extra\s*==\s*['\"]([\w.-]+)['\"]")
_BOUND = re.compile(r"(>=|<=|==|!=|~=|<|>)\s*([\d.]+)")


@dataclass(frozen=True, slots=True)
class Finding:
    """Result of examining one item of the installation; `remedy` says how to correct its fault."""

    group: str
    name: str
    status: Status
    value: str
    remedy: str = ""


@dataclass(frozen=True, slots=True)
class Installation(Displayed):
    """Results for all items that were examined; `ok` is True if no command will fail."""

    findings: tuple[Finding, ...]

    @property
    def ok(self) -> bool:
        """Whether everything that commands need is present."""
        return all(finding.status != "fault" for finding in self.findings)

    @property
    def in_short(self) -> tuple[str, str]:
        """The version, and the number of faults."""
        faults = sum(finding.status == "fault" for finding in self.findings)
        state = "complete" if self.ok else f"{faults} fault{'' if faults == 1 else 's'}"
        return "", f"actuator-opt {VERSION}, {state}"

    def to_dict(self) -> dict[str, Any]:
        """The object of `doctor --json`."""
        return {
            "version": VERSION,
            "python": platform.python_version(),
            "ok": self.ok,
            "findings": [asdict(finding) for finding in self.findings],
        }

    def text(self, **style: Unpack[Style]) -> str:
        """Return the terminal text."""
        from ..pages.runs import findings
        from ..rendering.terminal import blocks_text

        rows = [(x.group, x.name, x.status, x.value, x.remedy) for x in self.findings]
        return blocks_text([findings(rows)], **style)


@guarded
def doctor(
    *, out: str | Path = "reports", runs: str | Path | None = None, terminal: str = ""
) -> Installation:
    """Check Python, dependencies, extras, fonts, data, folders and the machine.

    Parameters
    ----------
    out : folder for reports
    runs : folder of run records; None if no runs are recorded
    terminal : capabilities of the terminal, in words; "" leaves them out of the list
    """
    program = Finding("program", _NAME, "ok", f"{VERSION}, {Path(__file__).parents[1]}")
    findings = [_python(), program, *_packages(), _fonts(), _materials()]
    findings.append(_folder("reports", Path(out), "name another folder with --out"))
    if runs is None:
        findings.append(Finding("folder", "runs", "ok", "no runs are recorded"))
    else:
        findings.append(_folder("runs", Path(runs), "set ACTUATOR_OPT_RUNS to another folder"))
    findings.append(_programs())
    if terminal:
        findings.append(Finding("terminal", "output", "ok", terminal))
    return Installation((*findings, _machine(), _compiled()))


def _python() -> Finding:
    good = sys.version_info >= _OLDEST
    oldest = ".".join(map(str, _OLDEST))
    value = f"{platform.python_version()}, {sys.executable}"
    remedy = "" if good else f"install Python {oldest} or later"
    return Finding("program", "Python", "ok" if good else "fault", value, remedy)


def _requirements() -> tuple[list[str], dict[str, list[str]]]:
    """Packages that the project requires, and packages that each extra requires."""
    project = Path(__file__).parents[2] / "pyproject.toml"
    if project.is_file():
        project_table = tomllib.loads(project.read_text("utf-8")).get("project", {})
        if project_table.get("name") == _NAME:
            return project_table["dependencies"], project_table.get("optional-dependencies", {})
    core: list[str] = []
    extras: dict[str, list[str]] = {}
    try:
        for text in metadata.requires(_NAME) or []:
            extra = _EXTRA.search(text)
            (core if extra is None else extras.setdefault(extra[1], [])).append(text)
    except metadata.PackageNotFoundError:
        return [], {}
    return core, extras


def _packages() -> Iterator[Finding]:
    """Examine every required package, and every extra except those for developers."""
    core, extras = _requirements()
    modules: dict[str, list[str]] = {}
    for module, names in metadata.packages_distributions().items():
        for name in names:
            modules.setdefault(_normal(name), []).append(module)
    if not core:
        remedy = "install it with pip"
        yield Finding(
            "dependency", _NAME, "fault", "the list of packages that it needs is missing", remedy
        )
    for text in core:
        name, value, fault = _package(text, modules)
        remedy = f"pip install '{text.strip()}'" if fault else ""
        yield Finding("dependency", name, "fault" if fault else "ok", fault or value, remedy)
    for extra, texts in extras.items():
        if extra in ("test", "dev"):
            continue
        packages = [_package(text, modules) for text in texts]
        faults = [f"{name} {fault}" for name, _, fault in packages if fault]
        values = [f"{name} {value}" for name, value, fault in packages if not fault]
        remedy = f"to add it: pip install '{_NAME}[{extra}]'" if faults else ""
        value = ", ".join(faults or values)
        yield Finding("extra", extra, "missing" if faults else "ok", value, remedy)


def _package(text: str, modules: dict[str, list[str]]) -> tuple[str, str, str]:
    """Name, version and problem of a required package, which is imported for the check."""
    match = _REQUIREMENT.match(text.strip())
    assert match is not None, text
    name = match[1]
    try:
        version = metadata.version(name)
    except metadata.PackageNotFoundError:
        return name, "", "is not installed"
    if not _fits(version, match[3]):
        return name, version, f"{version} is installed, {match[3].strip()} is needed"
    own = sorted(modules.get(_normal(name), []))
    own = [x for x in own if _normal(x) == _normal(name)] or [x for x in own if x[0] != "_"]
    try:
        import_module(own[0] if own else name)
    except (ImportError, OSError, AttributeError, RuntimeError, TypeError, ValueError) as error:
        reason = (str(error).strip() or type(error).__name__).splitlines()[0]
        return name, version, f"{version} cannot be imported: {reason}"
    return name, version, ""


def _normal(name: str) -> str:
    return re.sub(r"[-_.]+", "-", name).lower()


def _numbers(version: str) -> tuple[int, ...]:
    """The release numbers of a version, without a suffix (rc1, .dev0)."""
    match = re.match(r"\d+(?:\.\d+)*", version)
    return () if match is None else tuple(map(int, match[0].split(".")))


def _fits(version: str, bounds: str) -> bool:
    """Whether a version satisfies bounds such as ``>=12,<13``.

    >>> _fits("12.0.2", ">=12,<13"), _fits("13.0", ">=12,<13"), _fits("2.10", ">=2.9")
    (True, False, True)
    """
    numbers = _numbers(version)
    for sign, text in _BOUND.findall(bounds):
        limit = _numbers(text)
        size = max(len(numbers), len(limit))
        a, b = (x + (0,) * (size - len(x)) for x in (numbers, limit))
        satisfied = {
            ">=": a >= b, "<=": a <= b, "==": a == b, "!=": a != b, "<": a < b, ">": a > b,
            "~=": a >= b and a[: len(limit) - 1] == b[: len(limit) - 1],
        }[sign]  # fmt: skip
        if not satisfied:
            return False
    return True


def _fonts() -> Finding:
    from ..rendering.paper import font_folders

    folders = [Path(folder) for folder in font_folders()]
    missing = [name for name in _FONTS if not any((folder / name).is_file() for folder in folders)]
    if missing:
        value = f"{', '.join(missing)} not found"
        return Finding("data", "fonts", "fault", value, "pip install --force-reinstall matplotlib")
    return Finding("data", "fonts", "ok", f"{len(_FONTS)} of {len(_FONTS)} in {folders[0]}")


def _materials() -> Finding:
    from ..design.materials import load_library

    try:
        folder = store.data_folder("materials")
        count = sum(1 for _ in load_library())
    except InputError as error:
        return Finding("data", "materials", "fault", str(error), f"install {_NAME} again")
    return Finding("data", "materials", "ok", f"{count} entries in {folder}")


def _folder(name: str, folder: Path, remedy: str) -> Finding:
    reason = store.unwritable(folder)
    if reason:
        return Finding("folder", name, "fault", f"cannot be written: {reason}", remedy)
    remark = "" if folder.is_dir() else " (made when needed)"
    return Finding("folder", name, "ok", f"{folder.absolute()}{remark}")


def _programs() -> Finding:
    from ..base.symbolic.program_store import FOLDER, folder

    place, remedy = folder(), f"set {FOLDER} to another folder"
    if place is None:
        return Finding("folder", "recorded models", "ok", "none are stored")
    finding = _folder("recorded models", place, remedy)
    if finding.status == "ok":
        return finding
    words = f"not stored, so every run must record them again: {finding.value}"
    return Finding("folder", "recorded models", "missing", words, remedy)


def _machine() -> Finding:
    try:
        usable = len(os.sched_getaffinity(0))
    except AttributeError:  # not available on every system
        usable = os.cpu_count() or 1
    words = f"{usable} of {os.cpu_count() or usable} can be used; {_system()}"
    return Finding("machine", "cores", "ok", words)


def _compiled() -> Finding:
    from ..base.symbolic.program import AVAILABLE

    if AVAILABLE:
        return Finding("machine", "recorded models", "ok", "run by the compiled virtual machine")
    words = "run by NumPy, which is slower: there was no C compiler at installation"
    remedy = f"install {_NAME} again with a C compiler"
    return Finding("machine", "recorded models", "missing", words, remedy)


def _system() -> str:
    parts: Sequence[str] = (platform.system(), platform.release(), platform.machine())
    return " ".join(part for part in parts if part)
