"""Reference pages of the commands, from the declarations that make their help."""

from __future__ import annotations

from typing import Any

from actuator_opt.base.errors import EXIT_CODES
from actuator_opt.cli.app import HIDDEN, command_line

from .book import Book
from .markdown import escaped, fence, page, phrase, table


def _commands() -> dict[str, Any]:
    """All commands by name, those of a family too (`runs show`)."""
    found: dict[str, Any] = {}
    for name, command in command_line(()).commands.items():
        if name in HIDDEN:
            continue
        found[name] = command
        for below, inner in getattr(command, "commands", {}).items():
            found[f"{name} {below}"] = inner
    return found


def register(book: Book) -> None:
    """Register every command with its page."""
    for name in _commands():
        book.register("command", name, f"reference/commands/{name.split()[0]}")


def write(book: Book) -> None:
    """Write a page for each command, or family of commands, and their list."""
    commands = _commands()
    families: dict[str, list[str]] = {}
    for name in commands:
        families.setdefault(name.split()[0], []).append(name)
    for first, names in families.items():
        parts = [_section(name, commands[name], book, "#" if name == first else "##")
                 for name in names]  # fmt: skip
        book.pages[f"reference/commands/{first}"] = page(*parts)
    rows = [
        (f"{{command}}`{n}`", phrase(_help(c).partition("\n\n")[0])) for n, c in commands.items()
    ]
    codes = [(str(int(code)), phrase(words)) for code, words in EXIT_CODES.items()]
    book.pages["reference/commands/index"] = page(
        "# Commands",
        table(("command", "what it does"), rows),
        "Data go to standard output, messages to standard error. `--json` prints one object in SI "
        "units, also for faults.",
        "## Exit codes",
        table(("code", "meaning"), codes),
        fence("{toctree}", ":hidden:\n\n" + "\n".join(families)),
    )


def _help(command: Any) -> str:
    return str(command.help or "").replace("\f", "").strip()


def _usage(name: str, command: Any) -> str:
    words = [f"actuator-opt {name}"]
    if getattr(command, "commands", None):
        return " ".join([*words, "COMMAND"])
    arguments = [p for p in command.params if p.param_type_name == "argument"]
    words += ["[OPTIONS]"] if len(arguments) < len(command.params) else []
    return " ".join([*words, *(_argument(p) for p in arguments)])


def _argument(param: Any) -> str:
    name = param.metavar or param.name.upper()
    return name if param.required or name.startswith("[") else f"[{name}]"


def _section(name: str, command: Any, book: Book, level: str) -> str:
    parts = [f"{book.at('command', name)}\n{level} {name}"]
    book.require("command", name, definition=_help(command))
    parts.append("\n\n".join(phrase(text) for text in _help(command).split("\n\n")))
    parts.append(fence("text", _usage(name, command)))
    if getattr(command, "commands", None):
        return page(*parts).rstrip()
    rows = []
    for param in command.params:
        if getattr(param, "hidden", False):
            continue
        help_text = getattr(param, "help", None) or ""
        book.require("command", f"{name} {'/'.join(param.opts)}", definition=help_text)
        if param.param_type_name == "argument":
            rows.append((f"`{_argument(param)}`", phrase(help_text), ""))
            continue
        value = "" if param.is_flag else f" {param.metavar or param.name.upper()}"
        shown = "" if param.is_flag or param.default in (None, ()) else str(param.default)
        opts = ", ".join(f"`{opt}{value if opt.startswith('--') else ''}`" for opt in param.opts)
        rows.append((opts, phrase(help_text), escaped(shown)))
    parts.append(table(("argument or option", "meaning", "default"), rows))
    return page(*parts).rstrip()
