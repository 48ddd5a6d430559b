"""The directive `validation`: tables of published values beside ours, computed by the build.

``{validation} GROUP`` is a table of the cases of a group, ``{validation} claims`` and
``{validation} agreements`` the statements and second programs, ``{validation} summary`` a sentence
with all counts. A verdict that does not fit its reason is an error of the build.
"""

from __future__ import annotations

from typing import Any

from docutils import nodes
from sphinx.util.docutils import SphinxDirective

from .validation_cases import AGREEMENTS, CLAIMS, GROUPS, faults
from .validation_rows import Case


def number(value: float) -> str:
    """Five significant digits, as an engineer writes them."""
    text = f"{value:.5g}"
    mantissa, e, power = text.partition("e")
    return f"{mantissa} × 10^{int(power)}".replace("10^", "10<sup>") + "</sup>" if e else text


def published(case: Case) -> str:
    """The published number or range, with its unit."""
    ends = case.published if isinstance(case.published, tuple) else (case.published,)
    return f"{' to '.join(f'{end:.7g}' for end in ends)} {case.unit}".strip()


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
        rows = [["quantity", "published", "source", "computed", "deviation", "verdict", "test"]]
        for case in GROUPS[group]():
            words = f"{_verdict(case.reproduced())}{': ' if case.why else ''}{case.why}"
            ours = f"{number(case.value())} {case.unit}".strip()
            row = [case.subject, published(case), case.source, ours, deviation(case), words]
            rows.append([*row, mark(case.tests)])
    return rows, list(found)


def _verdict(holds: bool) -> str:
    return "reproduced" if holds else "**contradicted**"


def summary() -> str:
    """Counts of all cases and statements."""
    cases = [case for group in GROUPS.values() for case in group()]
    good, held = sum(case.reproduced() for case in cases), sum(claim.holds for claim in CLAIMS)
    return (
        f"{len(cases)} numbers: {good} are reproduced, {len(cases) - good} are contradicted, each "
        f"with its reason. {len(CLAIMS)} statements without a number: {held} are confirmed, "
        f"{len(CLAIMS) - held} are not. {len(AGREEMENTS)} second programs agree."
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
