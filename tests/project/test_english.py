"""Plain English: docstrings, comments and messages keep clear of crutches that hide the meaning.

`PACKAGES` grows as further packages become clean. A pattern is a question to the writer: name the
thing, then say what it does. `ALLOWED` excuses a text that needs the words, with the reason.
"""

import ast
import io
import re
import tokenize
from collections.abc import Iterator, Sequence
from functools import cache
from pathlib import Path

import pytest
from cases.sources import parsed

ROOT = Path(__file__).resolve().parents[2] / "actuator_opt"

PACKAGES = (
    "api",
    "base",
    "cli",
    "design",
    "evaluation",
    "explorer",
    "studio",
    "exports",
    "finite_elements",
    "friction",
    "identification",
    "joints",
    "lubrication",
    "metrics",
    "models",
    "optimisation",
    "pages",
    "rendering",
    "replicas",
    "seals",
    "simulation",
    "studies",
    "sweeps",
    "uncertainties",
)
"""Packages whose English is plain."""

MOST_WORDS = 35
"""Largest number of words in the summary of a docstring."""

BANNED = {
    r"\bwhat (it|they) (came|comes|come) to\b": "name the result",
    r"\bas (it|they) stands?\b": "say: unchanged, current, as in the file",
    r"\bstand(s|ing)? for\b": "say: is, means, represents",
    r"\b(it|this|they) stands?\b": "say where it is",
    r"\b(tells?|told)\b": "say: state, show, report, return",
    r"\b(the|a|is|was|what) founds?\b(?! (by|in|at|on|out|from|to))": "`found` is no noun",
    r"\b(is|are|was|were) to (?!(the|a|an|its|their)\b)[a-z]+\b(?! (zero|one)\b)": "say: must, may",
    r"\basks? of\b|\basked of\b": "say: requires, demands",
    r"\bwhat\b[\w ]*\b(is|are) made of\b": "list the parts",
    r"\bwhat there (is|are)\b": "name the things",
    r"\b(where|because|why) there (is|are) none\b": "say: if missing, reason for a missing value",
    r"\b(each|every|any|no|another|other|either|which|last|first|new|same|own) one\b(?![ -]"
    r"(line|row|design|case|entry|half|ply|point|metric|edge|block|node|place|layer|of|per|thread)"
    r")": "repeat the noun",
    r"\bthe ones?\b(?!-| of (the|its)\b| [a-z]+s? )": "repeat the noun",
    r"\bthe ones? (that|who|which|of|in|at|with|before|after|there|not)\b": "repeat the noun",
    r"\bno finite answer\b": "say: not computable, not finite",
    r"\b(a|the) person('s)?\b|\bstrangers?\b|\bwhoever\b": "say: the user, the reader",
    r"\bhangs? on\b": "say: depends on",
    r"\bmend\b": "say: correct, repair",
    r"\bholds? (no|nothing|what)\b": "say: contains, seals, keeps",
    r"\b(room|way|place) (is|are) left\b": "say: remains",
    r"\bin all\b(?! (cases|directions))": "say: in total",
    r"\bmuch (as|the) same\b": "say what is equal",
    r"\b(did|does|do) (its|the|their) work\b": "say what was used",
    r"\bneeds it\b(?!, or\b)": "say: required by",
    r"\bnot any more\b|\bno longer (so|that)\b": "say what changed",
    r"\bsettled\b": "say: converged",
    r"\bfrom an instant on\b": "say: after `time`",
    r"\bof all that\b|\ball that (is|was|has)\b": "name the things",
}
"""Patterns of words, each with the plain way to say it."""

RIDDLES = {
    r"\A(What|Whatever|Everything that|How|That which)\b(?! [\w`]+ (is|are) called)": "name it",
    r"\AOf \w+": "name the thing first",
    r"\A(It|They|That|This)\b": "name the thing first",
}
"""Patterns at the start of a docstring."""

ALLOWED = {
    "missing: joint_torque needs it, or a linkage": "two ways out, named in one line",
}
"""Texts that need the words of a pattern, with the reason."""

WORD = re.compile(r"[A-Za-z][\w'-]*")


def modules() -> list[Path]:
    """All modules of the clean packages."""
    return [path for name in PACKAGES for path in sorted((ROOT / name).rglob("*.py"))]


def docstrings(nodes: Sequence[ast.AST]) -> list[ast.Constant]:
    """Docstrings of module, classes, functions and attributes."""
    bodies = [getattr(node, "body", None) for node in nodes]
    return [
        statement.value
        for body in bodies
        if isinstance(body, list)
        for statement in body
        if isinstance(statement, ast.Expr)
        and isinstance(statement.value, ast.Constant)
        and isinstance(statement.value.value, str)
    ]


def spoken(text: str) -> str:
    """A docstring without its doctests and without code in backquotes."""
    lines = [line for line in text.splitlines() if not line.lstrip().startswith((">>>", "..."))]
    return re.sub(r"``?[^`\n]+``?", "`code`", "\n".join(lines))


def is_message(text: str) -> bool:
    """Whether a literal is a text for people: words, and not only a value with its unit."""
    return len(WORD.findall(text)) >= 2 and " " in text.strip()


def messages(source: str, nodes: Sequence[ast.AST]) -> Iterator[tuple[int, str]]:
    """Line and text of user-facing literals; a formatted value becomes ``{}``.

    Keys, raw strings (regular expressions), SQL and docstrings are left out.
    """
    lines = source.encode().split(b"\n")  # `ast.get_source_segment` splits the source each time
    skipped = {id(node) for node in docstrings(nodes)}
    for node in nodes:
        if isinstance(node, ast.Dict):
            skipped |= {id(key) for key in node.keys if isinstance(key, ast.Constant)}
        elif isinstance(node, ast.Subscript):
            skipped.add(id(node.slice))
        elif isinstance(node, ast.JoinedStr):
            skipped |= {id(part) for part in ast.walk(node) if part is not node}
    for node in nodes:
        if id(node) in skipped:
            continue
        if isinstance(node, ast.JoinedStr):
            parts = [part.value if isinstance(part, ast.Constant) else "{}" for part in node.values]
            text = "".join(str(part) for part in parts)
        elif isinstance(node, ast.Constant) and isinstance(node.value, str):
            text = node.value
        else:
            continue
        raw = lines[node.lineno - 1][node.col_offset :].startswith((b"r", b"R"))
        sql = re.match(r"\s*(SELECT|INSERT|UPDATE|CREATE|PRAGMA|BEGIN)\b", text)
        if not raw and not sql and is_message(text):
            yield node.lineno, text


@cache
def texts_of(path: Path) -> tuple[list[tuple[int, str]], list[tuple[int, str]]]:
    """Line and text of the docstrings of a module, and of its messages."""
    source, tree = parsed(path)
    nodes = list(ast.walk(tree))
    said = [(node.lineno, spoken(str(node.value))) for node in docstrings(nodes)]
    return said, list(messages(source, nodes))


def comments(source: str) -> Iterator[tuple[int, str]]:
    """Line and text of the comments."""
    for token in tokenize.generate_tokens(io.StringIO(source).readline):
        if token.type == tokenize.COMMENT:
            yield token.start[0], token.string


def faults(text: str, patterns: dict[str, str]) -> Iterator[str]:
    """Each banned pattern in a text, with the plain way to say it."""
    if text in ALLOWED:
        return
    for pattern, advice in patterns.items():
        match = re.search(pattern, text)
        if match:
            yield f'"{match.group()}" in "{text.strip()[:80]}": {advice}'


def summary(text: str) -> str:
    """The first paragraph of a docstring."""
    return text.strip().split("\n\n")[0]


def of_module(path: Path) -> list[str]:
    """All faults of the English of a module."""
    source = path.read_text(encoding="utf-8")
    said_of_module, shown = texts_of(path)
    found = []
    for line, text in said_of_module:
        said = [*faults(text, BANNED), *faults(text.strip(), RIDDLES)]
        longest = max(len(WORD.findall(part)) for part in re.split(r"[.;:] ", summary(text)))
        if longest > MOST_WORDS:
            said.append(f'{longest} words in a sentence of "{summary(text)[:60]}": split it')
        found += [(line, fault) for fault in said]
    hashed = (line[line.index("#") :] for line in source.splitlines() if "#" in line)
    suspect = any(fault for text in hashed for fault in faults(text, BANNED))
    for line, text in [*shown, *(comments(source) if suspect else ())]:
        found += [(line, fault) for fault in faults(text, BANNED)]
    return [f"{path.relative_to(ROOT)}:{line}: {fault}" for line, fault in sorted(found)]


@pytest.mark.parametrize("name", PACKAGES)
def test_plain_english(name: str) -> None:
    """A package has no crutch in its docstrings, comments and messages."""
    found = [fault for path in sorted((ROOT / name).rglob("*.py")) for fault in of_module(path)]
    assert not found, "\n".join(found)


def test_allowed_texts_exist() -> None:
    """Every excuse is still needed."""
    texts = set()
    for path in modules():
        texts |= {text for part in texts_of(path) for _, text in part}
    assert set(ALLOWED) <= texts
    assert all(len(reason.split()) > 2 for reason in ALLOWED.values())


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("what it came to", 1),
        ("every check as it stands", 2),
        ("a symbol stands for a number", 1),
        ("the report tells the yield", 1),
        ("the pressure asked of the seal", 1),
        ("the file is to be written", 1),
        ("compare each one with the last", 1),
        ("what a type is made of", 1),
        ("True after `time`; the integrator restarts there.", 0),
        ("one line for every case", 0),
        ("the ratio is to the second decimal", 0),
        ("roots found by bisection", 0),
    ],
)
def test_patterns(text: str, expected: int) -> None:
    """The patterns meet crutches, and nothing else."""
    assert len(list(faults(text, BANNED))) == expected
