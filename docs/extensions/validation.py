"""The directive `validation`: tables of published values beside ours, computed by the build.

``{validation} GROUP`` is a table of the cases of a group, ``{validation} claims`` and
``{validation} agreements`` the statements and second programs, ``{validation} summary`` a sentence
with all counts, ``{validation} sources`` one on the sources that were read. A verdict that does not
fit its reason is an error of the build.
"""

from __future__ import annotations

from typing import Any

from docutils import nodes
from sphinx.util.docutils import SphinxDirective

from .models import references
from .validation_cases import AGREEMENTS, CLAIMS, GROUPS, faults
from .validation_rows import Case

HEADS = {"optimisation": "best known value", "independent": "own calculation"}
"""Heading of the values of a group that are not published in the source itself."""


def number(value: float, digits: int = 5) -> str:
    """Some significant digits, as an engineer writes them."""
    text = f"{value:.{digits}g}"
    mantissa, e, power = text.partition("e")
    return f"{mantissa} × 10^{int(power)}".replace("10^", "10<sup>") + "</sup>" if e else text


def published(case: Case) -> str:
    """The published number or range, with its unit."""
    if case.agreement:
        return "(1: full agreement)"
    ends = case.published if isinstance(case.published, tuple) else (case.published,)
    digits = 10 if case.within < 1e-6 else 7
    return f"{' to '.join(number(end, digits) for end in ends)} {case.unit}".strip()


def deviation(case: Case) -> str:
    """The deviation in per cent, or as a factor where it is large."""
    share = case.deviation()
    if abs(share) < 1e-6:
        return "0"
    if abs(share) >= 2:
        return f"factor {1 + share:.3g}"
    text = f"{100 * share:+.2f} %" if abs(share) >= 1e-4 else f"{100 * share:+.4f} %"
    return text.replace("-", "−")


def rows_of(group: str) -> tuple[list[list[str]], list[str]]:
    """Heading and rows of a table in Markdown, and its tests in order."""
    found: dict[str, int] = {}

    def mark(name: str) -> str:
        return str(found.setdefault(name, len(found) + 1))

    if group == "claims":
        rows = [["statement", "source", "ours", "verdict", "test"]]
        rows += [[c.subject, c.source, c.ours, _verdict(c.holds), mark(c.tests)] for c in CLAIMS]
    elif group == "agreements":
        rows = [["what", "second program", "agreement", "test"]]
        rows += [[a.subject, a.program, a.within, mark(a.tests)] for a in AGREEMENTS]
    else:
        theirs = HEADS.get(group, "published")
        head = ["quantity", theirs, "computed", "deviation", "tolerance", "verdict", "source"]
        rows = [[*head, "test"]]
        for case in GROUPS[group]():
            ours = f"{number(case.value())} {case.unit}".strip()
            within = f"{number(100 * case.within, 3)} %"
            row = [case.subject, published(case), ours, deviation(case), within, verdict(case)]
            rows.append([*row, case.source, mark(case.tests)])
    return rows, list(found)


def verdict(case: Case) -> str:
    """Verdict of a number, with its reason."""
    if case.solved:
        return f"input that would explain it: {case.solved}"
    return f"{_verdict(case.reproduced())}{': ' if case.why else ''}{case.why}"


def _verdict(holds: bool) -> str:
    return "reproduced" if holds else "**contradicted**"


def summary() -> str:
    """Counts of all cases and statements."""
    rows = [(group, case) for group, cases in GROUPS.items() for case in cases()]
    solved = [case for _, case in rows if case.solved]
    own = [case for group, case in rows if group == "independent" or case.agreement]
    cases = [case for _, case in rows if case not in solved and case not in own]
    good, held = sum(case.reproduced() for case in cases), sum(claim.holds for claim in CLAIMS)
    same = sum(case.reproduced() for case in own)
    return (
        f"{len(cases)} numbers of others: {good} are reproduced, {len(cases) - good} are "
        f"contradicted, each with its reason. {len(solved)} more need an input that was solved "
        f"from, or copied from, the published value: they confirm nothing. {len(own)} rows compare "
        f"with own calculations or whole runs of others: {same} agree. {len(CLAIMS)} statements "
        f"without a number: {held} are confirmed, {len(CLAIMS) - held} are not. "
        f"{len(AGREEMENTS)} second programs agree."
    )


def sources() -> str:
    """How many sources were read."""
    seen = [entry["seen"] for entry in references().values()]
    read = seen.count("source")
    return (
        f"{read} of the {len(seen)} sources in the list of {{doc}}`references <reference/sources>` "
        f"were read for this project. The other {len(seen) - read} are quoted from memory, and "
        "their pages were not read again. This includes most textbooks and standards."
    )


class Validation(SphinxDirective):
    """A table, or the sentence with all counts."""

    required_arguments = 1

    def run(self) -> list[nodes.Node]:
        """The parsed table."""
        self.env.note_reread()  # it depends on the package, not on the page
        group = self.arguments[0]
        if group == "summary":
            wrong = faults()
            if wrong:
                raise self.error("\n".join(wrong))
            return self.parse_text_to_nodes(summary())
        if group == "sources":
            return self.parse_text_to_nodes(sources())
        if group not in {*GROUPS, "claims", "agreements"}:
            raise self.error(f"no group {group!r}; there are {', '.join(GROUPS)}")
        (head, *rows), tests = rows_of(group)
        lines = [head, ["---"] * len(head), *rows]
        text = [
            "```{table}", ":class: wide-first", "",
            *(f"| {' | '.join(row)} |" for row in lines), "```", "", "Tests:", "",
            *(f"{k}. {{test}}`{name}`" for k, name in enumerate(tests, 1)),
        ]  # fmt: skip
        return self.parse_text_to_nodes("\n".join(text))


def setup(app: Any) -> dict[str, bool]:
    """Register the directive."""
    app.add_directive("validation", Validation)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
