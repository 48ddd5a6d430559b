"""Blocks marked `run`: executed before the build, their output put in by the directive `run`.

All blocks of a page run one after the other in a scratch folder of the page, which begins with a
copy of ``designs/``. Commands run as in a person's terminal of 80 columns without colours; Python
blocks share one namespace. The results of a page are kept under the hash of the package, its data
and the page's blocks, so that only changed pages run again.
"""

from __future__ import annotations

import contextlib
import hashlib
import io
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
import traceback
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import asdict, dataclass, field
from multiprocessing import get_context
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[2]
COLUMNS = 80
SECONDS = 120
"""Longest time of one command."""
FLAGS = {"hide-output", "hide-code"}
VALUES = {"exit", "lines", "figure", "alt", "write", "without"}
KINDS = {"console", "python", "json", "text"}


class RunFault(Exception):
    """A block that cannot run, or gave an unexpected exit code."""


@dataclass(frozen=True)
class Block:
    """A block marked `run`: its kind, options, text, and first line on the page."""

    kind: str
    options: Mapping[str, str]
    text: str
    line: int


@dataclass
class Output:
    """What a block printed, and the image that it wrote (a file of the cache)."""

    text: str = ""
    figure: str = ""
    commands: list[tuple[str, str]] = field(default_factory=list)
    """Each command of a console block with its output."""


# --- blocks of a page ----------------------------------------------------------------------------


def blocks(text: str) -> list[Block]:
    """All blocks marked `run` of a page, also those inside other directives."""
    from markdown_it import MarkdownIt

    found = []
    for token in MarkdownIt("commonmark").enable("table").parse(text):
        if token.type != "fence" or not token.info.strip().startswith("{"):
            continue
        start = token.map[0] + 1 if token.map else 0
        if not token.info.strip().startswith("{run}"):
            found += [
                Block(b.kind, b.options, b.text, b.line + start) for b in blocks(token.content)
            ]
            continue
        found.append(_block(token.info.strip().removeprefix("{run}").strip(), token.content, start))
    return found


def _block(kind: str, content: str, line: int) -> Block:
    options: dict[str, str] = {}
    lines = content.splitlines()
    while lines and lines[0].startswith(":"):
        name, _, value = lines.pop(0)[1:].partition(":")
        if name not in FLAGS | VALUES:
            raise RunFault(f"line {line}: unknown option {name!r} of a run block")
        options[name] = value.strip()
    if kind not in KINDS:
        raise RunFault(f"line {line}: a run block is console, python, json or text, not {kind!r}")
    if kind == "text" and "write" not in options:
        raise RunFault(f"line {line}: a run block of text needs :write: FILE")
    while lines and not lines[0].strip():
        lines.pop(0)
    return Block(kind, options, "\n".join(lines).rstrip() + "\n", line)


# --- running -------------------------------------------------------------------------------------


def _environment(scratch: Path) -> dict[str, str]:
    state = scratch.parent / "state"
    return os.environ | {
        "COLUMNS": str(COLUMNS),
        "NO_COLOR": "1",
        "TERM": "dumb",
        "PYTHONPATH": str(ROOT),
        "PYTHONIOENCODING": "utf-8",
        "PYTHONHASHSEED": "0",
        "MPLBACKEND": "Agg",
        "ACTUATOR_OPT_RUNS": str(state / "runs"),
        "PATH": os.pathsep.join([str(Path(sys.executable).parent), os.environ.get("PATH", "")]),
    }


def _terminal(command: str, scratch: Path) -> tuple[int, str]:
    """Exit code and text of a shell command in a terminal without keyboard."""
    import pty

    leader, follower = pty.openpty()
    with contextlib.closing(os.fdopen(leader, "rb", 0)) as screen:
        process = subprocess.Popen(
            ["bash", "-c", command],
            cwd=scratch,
            env=_environment(scratch),
            stdin=subprocess.DEVNULL,
            stdout=follower,
            stderr=follower,
        )
        os.close(follower)
        chunks = []
        with contextlib.suppress(OSError):  # the terminal closes with its last process
            while chunk := screen.read(65536):
                chunks.append(chunk)
        code = process.wait(SECONDS)
    text = b"".join(chunks).decode("utf-8", "replace").replace("\r\n", "\n")
    return code, text.replace(str(scratch), "~")


def _console(block: Block, scratch: Path) -> Output:
    expected, output = int(block.options.get("exit", "0")), Output()
    commands = _commands(block.text)
    if not commands:
        raise RunFault("no line begins with '$ '")
    for k, command in enumerate(commands):
        code, text = _terminal(command, scratch)
        wanted = expected if k == len(commands) - 1 else 0
        if code != wanted:
            raise RunFault(f"$ {command}\n{text}exit code {code}, expected {wanted}")
        output.commands.append((command, text))
    output.text = "".join(f"$ {command}\n{text}" for command, text in output.commands)
    return output


def _commands(text: str) -> list[str]:
    """Commands of a console block; a backslash at its end continues a line."""
    commands: list[str] = []
    open_ = False
    for line in text.splitlines():
        if open_:
            commands[-1] += "\n" + line
        elif line.startswith("$ "):
            commands.append(line[2:])
        elif line.strip():
            raise RunFault(f"not a command: {line!r} (outputs are put in by the build)")
        open_ = line.endswith("\\")
    return commands


def _json(block: Block, scratch: Path, known: dict[str, set[str]]) -> Output:
    """Outline of the object that a command prints, without keys of earlier commands if named."""
    command = block.text.strip().removeprefix("$ ")
    done = subprocess.run(
        ["bash", "-c", command],
        cwd=scratch,
        env=_environment(scratch),
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
        timeout=SECONDS,
        check=False,
    )
    expected = int(block.options.get("exit", "0"))
    if done.returncode != expected:
        raise RunFault(f"$ {command}\n{done.stderr}exit code {done.returncode}")
    rows = outline(json.loads(done.stdout))
    known[command.split()[1]] = {path for path, _, _ in rows}
    left_out = known[block.options["without"]] if "without" in block.options else set()
    rows = [row for row in rows if row[0] not in left_out]
    return Output(json.dumps(rows), commands=[(command, "")])


def outline(value: Any, path: str = "") -> list[tuple[str, str, str]]:
    """Path, type and example of each key; entries of lists and of tables of one form are merged.

    >>> outline({"a": 1.5, "b": [{"c": "x"}, {"c": None}]})
    [('a', 'number', '1.5'), ('b[].c', 'text or null', '"x"')]
    """
    merged: dict[str, list[Any]] = {}
    _walk(value, path, merged)
    rows = []
    for name, values in merged.items():
        words = sorted({_word(x) for x in values}, key=lambda w: (w == "null", w))
        sample = next((x for x in values if x not in (None, [], {}, "")), values[0])
        short = float(f"{sample:.6g}") if isinstance(sample, float) else sample
        text = json.dumps(short, ensure_ascii=False)
        rows.append((name, " or ".join(words), text if len(text) <= 60 else text[:57] + "…"))
    return rows


def _word(value: Any) -> str:
    if value is None:
        return "null"
    if isinstance(value, bool):
        return "true or false"
    if isinstance(value, (int, float)):
        return "number"
    return {str: "text", list: "list", dict: "object"}[type(value)]


_TABLE = 6
"""Number of numbers from which an object counts as a table with free names."""


def _is_table(value: dict[str, Any]) -> bool:
    """Whether the keys of an object are names of things, so that one row describes all."""
    if any(not re.fullmatch(r"[a-z][a-z0-9_]*", name) for name in value):
        return True
    shapes = [frozenset(x) if isinstance(x, dict) else _word(x) for x in value.values()]
    if any(isinstance(shape, frozenset) for shape in shapes):
        first, *others = shapes
        return bool(others) and all(
            isinstance(shape, frozenset) and isinstance(first, frozenset) and shape & first
            for shape in others
        )
    return len(value) >= _TABLE and set(shapes) - {"null"} == {"number"}


def _walk(value: Any, path: str, merged: dict[str, list[Any]]) -> None:
    if isinstance(value, dict) and value:
        table = path.rpartition(".")[2].startswith("by_") or _is_table(value)
        name = "NAME" if table else ""
        for key, below in value.items():
            _walk(below, f"{path}.{name or key}" if path else name or key, merged)
    elif isinstance(value, list) and value:
        for below in value:
            if isinstance(below, dict):
                _walk(below, f"{path}[]", merged)
            else:
                merged.setdefault(f"{path}[]", []).append(below)
    else:
        merged.setdefault(path, []).append(value)


def _python(block: Block, scratch: Path, names: dict[str, Any]) -> Output:
    screen = io.TextIOWrapper(io.BytesIO(), encoding="utf-8", write_through=True)
    with contextlib.redirect_stdout(screen), contextlib.redirect_stderr(screen):
        try:
            exec(compile(block.text, "page", "exec"), names)
        except BaseException as error:
            trace = "".join(traceback.format_exception(error)[-3:])
            raise RunFault(f"{block.text}\n{trace}") from None
    return Output(screen.buffer.getvalue().decode("utf-8").replace(str(scratch), "~"))


def _page(name: str, items: list[Block], folder: str) -> str:
    """Run all blocks of a page; returns a fault in words, or ""."""
    target = Path(folder)
    with tempfile.TemporaryDirectory(prefix="actuator-opt-docs-") as home:
        scratch = Path(home).resolve() / "page"
        shutil.copytree(ROOT / "designs", scratch / "designs")
        os.chdir(scratch)
        os.environ.update(_environment(scratch))
        names: dict[str, Any] = {"__name__": "__main__"}
        known: dict[str, set[str]] = {}
        outputs = []
        for k, block in enumerate(items):
            try:
                output = _run(block, scratch, names, known)
                if wanted := block.options.get("figure"):
                    image = scratch / wanted
                    if not image.is_file():
                        raise RunFault(f"no image {wanted} was written")
                    output.figure = f"{k}{image.suffix}"
                    shutil.copy(image, target / output.figure)
            except (RunFault, subprocess.TimeoutExpired) as fault:
                os.chdir(ROOT)
                return f"docs/{name}.md:{block.line}: run block failed\n{fault}"
            outputs.append(asdict(output))
        os.chdir(ROOT)
    (target / "outputs.json").write_text(json.dumps(outputs), encoding="utf-8")
    return ""


def _run(block: Block, scratch: Path, names: dict[str, Any], known: dict[str, set[str]]) -> Output:
    if wanted := block.options.get("write"):
        path = scratch / wanted
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(block.text, encoding="utf-8")
        return Output()
    if block.kind == "console":
        return _console(block, scratch)
    if block.kind == "json":
        return _json(block, scratch, known)
    return _python(block, scratch, names)


# --- cache ---------------------------------------------------------------------------------------


def source_hash() -> str:
    """Hash of everything that decides an output: package, materials, designs, this module."""
    digest = hashlib.sha256()
    folders = [ROOT / name for name in ("actuator_opt", "materials", "designs")]
    files = [path for folder in folders for path in sorted(folder.rglob("*"))]
    for path in [*files, Path(__file__)]:
        if path.is_file() and "__pycache__" not in path.parts and path.suffix != ".so":
            digest.update(f"{path.relative_to(ROOT)}\0".encode())
            digest.update(hashlib.sha256(path.read_bytes()).digest())
    return digest.hexdigest()


def key(items: Iterable[Block], source: str) -> str:
    """Name of the results of a page's blocks in the cache."""
    text = json.dumps([[b.kind, dict(b.options), b.text] for b in items])
    return hashlib.sha256(f"{source}\n{text}".encode()).hexdigest()[:32]


def execute(pages: Mapping[str, str], cache: Path, workers: int = 2) -> dict[str, Path]:
    """Run the blocks of all pages whose results are not in the cache.

    Parameters
    ----------
    pages : text of each page by its name
    cache : folder with the results
    workers : number of pages that run at the same time

    Returns
    -------
    folder with ``outputs.json`` and figures for each page that has blocks

    Raises
    ------
    RunFault : blocks that failed, with page and line
    """
    source, folders, waiting = source_hash(), {}, []
    for name, text in pages.items():
        try:
            items = blocks(text)
        except RunFault as fault:
            raise RunFault(f"docs/{name}.md: {fault}") from None
        if items:
            folder = folders[name] = cache / key(items, source)
            if not (folder / "outputs.json").is_file():
                folder.mkdir(parents=True, exist_ok=True)
                waiting.append((name, items, str(folder)))
    if waiting:
        with get_context("spawn").Pool(workers, maxtasksperchild=1) as pool:
            faults = pool.starmap(_page, waiting, chunksize=1)
        if any(faults):
            raise RunFault("\n\n".join(fault for fault in faults if fault))
    for old in set(cache.iterdir() if cache.is_dir() else ()) - set(folders.values()):
        shutil.rmtree(old)
    return folders


# --- directive -----------------------------------------------------------------------------------


def setup(app: Any) -> dict[str, bool]:
    """Register the directive."""
    from docutils import nodes
    from docutils.parsers.rst import directives
    from sphinx.util.docutils import SphinxDirective

    class Run(SphinxDirective):
        """Put in a block with the output that `execute` stored."""

        required_arguments = 1
        has_content = True
        option_spec = dict.fromkeys(FLAGS, directives.flag) | dict.fromkeys(
            VALUES, directives.unchanged
        )

        def run(self) -> list[nodes.Node]:
            name, counts = self.env.current_document.docname, self.env.temp_data
            number = counts.get("run-blocks", 0)
            counts["run-blocks"] = number + 1
            folder = Path(self.env.app.config.run_folders[name])
            stored = json.loads((folder / "outputs.json").read_text("utf-8"))
            block = _block(self.arguments[0], self.block_text_of_options(), self.lineno)
            return list(self.shown(block, Output(**stored[number]), folder))

        def block_text_of_options(self) -> str:
            options = "".join(
                f":{key}: {value if value is not None else ''}\n"
                for key, value in self.options.items()
            )
            return options + "\n" + "\n".join(self.content)

        def code(self, text: str, language: str, *classes: str) -> nodes.Node:
            node = nodes.literal_block(text.rstrip("\n"), text.rstrip("\n"), language=language)
            node["classes"] = list(classes)
            node["highlight_args"] = {}
            return node

        def screen(self, output: Output, block: Block) -> nodes.Node:
            """Commands, each with its output, as on a terminal."""
            lines, parts = int(block.options.get("lines", "0")), []
            for command, text in output.commands:
                hidden = "hide-output" in block.options or block.kind == "json"
                parts.append(nodes.inline("", f"$ {command}\n", classes=["command"]))
                parts.append(nodes.Text("" if hidden else shortened(text, lines)))
            return nodes.literal_block("", "", *parts, classes=["run-console"])

        def shown(self, block: Block, output: Output, folder: Path) -> Iterator[nodes.Node]:
            written, shorten = block.options.get("write"), int(block.options.get("lines", "0"))
            hidden = "hide-output" in block.options
            if written:
                language = {".yaml": "yaml", ".py": "python"}.get(Path(written).suffix, "text")
                caption = nodes.paragraph("", "", nodes.literal("", written), classes=["run-file"])
                yield caption
                yield self.code(block.text, language)
            elif block.kind in ("console", "json"):
                yield self.screen(output, block)
                if block.kind == "json":
                    yield outline_table(json.loads(output.text))
            else:
                if "hide-code" not in block.options:
                    yield self.code(block.text, "python", "run-python")
                if output.text.strip() and not hidden:
                    yield self.code(shortened(output.text, shorten), "text", "run-output")
            if output.figure:
                yield self.image(block, folder / output.figure)

        def image(self, block: Block, path: Path) -> nodes.Node:
            alt = block.options.get("alt")
            if not alt:
                raise self.error("a :figure: needs :alt: with words for readers who cannot see it")
            return nodes.image(uri="/" + self.placed(path), alt=alt, classes=["run-figure"])

        def placed(self, path: Path) -> str:
            """The image copied below the sources, where Sphinx looks for files."""
            target = Path(self.env.srcdir) / "_figures" / path.parent.name / path.name
            target.parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(path, target)
            return target.relative_to(self.env.srcdir).as_posix()

    app.add_config_value("run_folders", {}, "", types=[dict])
    app.add_directive("run", Run)
    return {"parallel_read_safe": True, "parallel_write_safe": True}


def shortened(text: str, lines: int) -> str:
    """The first lines of an output, with the number of the others."""
    shown = text.splitlines()
    if not lines or len(shown) <= lines:
        return text
    return "\n".join([*shown[:lines], f"… ({len(shown) - lines} more lines)"]) + "\n"


def outline_table(rows: Iterable[tuple[str, str, str]]) -> Any:
    """Table of the keys of a JSON object."""
    from docutils import nodes

    def row(cells: Iterable[Any]) -> Any:
        entries = [nodes.entry("", nodes.paragraph("", "", cell)) for cell in cells]
        return nodes.row("", *entries)

    group = nodes.tgroup(cols=3)
    group += [nodes.colspec(colwidth=width) for width in (40, 20, 40)]
    group += nodes.thead("", row(nodes.Text(word) for word in ("key", "type", "example")))
    group += nodes.tbody(
        "",
        *(
            row([nodes.literal("", path), nodes.Text(kind), nodes.literal("", example)])
            for path, kind, example in rows
        ),
    )
    return nodes.table("", group, classes=["json-outline"])
