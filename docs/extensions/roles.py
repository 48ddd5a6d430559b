"""Roles that link to a reference entry, and the directive `model`.

An unknown name is a warning, and so an error of the build, with the nearest known names.
"""

from __future__ import annotations

import re
from difflib import get_close_matches
from typing import Any

from docutils import nodes
from sphinx import addnodes
from sphinx.util.docutils import SphinxDirective, SphinxRole

from .models import described, function, test_exists
from .names import known_label

KINDS = (
    "source", "metric", "key", "model", "command", "material", "check", "joint", "seal", "law",
    "property", "python", "scenario",
)  # fmt: skip


class Named(SphinxRole):
    """A link to the reference entry of a name."""

    def __init__(self, kind: str) -> None:
        super().__init__()
        self.kind = kind

    def run(self) -> tuple[list[nodes.Node], list[nodes.system_message]]:
        """The link, or the text and a warning."""
        given = re.fullmatch(r"(.*?)\s*<([^<>]+)>", self.text, flags=re.DOTALL)
        words, name = (given[1], given[2]) if given else (self.text, self.text)
        literal: nodes.Element = nodes.literal("", words, classes=[self.kind])
        if self.kind == "source":
            literal = nodes.inline("", f"[{words}]" if not given else words, classes=["source"])
        label = known_label(self.config.reference_labels, self.kind, name.strip())
        if label is None:
            if self.kind == "model" and self.elsewhere(name):
                return [literal], []
            known = self.config.reference_labels.get(self.kind, {})
            near = ", ".join(get_close_matches(name, known, 3, 0.5)) or "see the reference"
            message = f"unknown {self.kind} {name!r}; nearest: {near}"
            return [literal], [self.inliner.reporter.warning(message, line=self.lineno)]
        link = addnodes.pending_xref(
            "", literal, refdomain="std", reftype="ref", reftarget=label, refexplicit=True,
            refwarn=True, refdoc=self.env.current_document.docname,
        )  # fmt: skip
        return [link], []

    @staticmethod
    def elsewhere(name: str) -> bool:
        """Whether a name is a function of the package outside the models."""
        try:
            function(name)
        except LookupError:
            return False
        return True


class Test(SphinxRole):
    """The name of a test, which must exist."""

    def run(self) -> tuple[list[nodes.Node], list[nodes.system_message]]:
        """The name in code, or a warning."""
        literal = nodes.literal("", self.text, classes=["test"])
        if test_exists(self.text):
            return [literal], []
        message = f"no test {self.text!r}"
        return [literal], [self.inliner.reporter.warning(message, line=self.lineno)]


class Model(SphinxDirective):
    """Formula, valid range, source and example of a function, from its docstring."""

    required_arguments = 1

    def run(self) -> list[nodes.Node]:
        """The parsed text, with a link to the reference."""
        name = self.arguments[0]
        try:
            text = described(name)
        except LookupError as fault:
            raise self.error(str(fault)) from None
        box = nodes.container(classes=["model"])
        head = f"**{{model}}`{name}`**\n\n" if name.count(".") == 1 else f"**`{name}`**\n\n"
        box += self.parse_text_to_nodes(head + text)
        return [box]


def setup(app: Any) -> dict[str, bool]:
    """Register roles and directive."""
    app.add_config_value("reference_labels", {}, "env", types=[dict])
    for kind in KINDS:
        app.add_role(kind, Named(kind), override=True)
    app.add_role("test", Test(), override=True)
    app.add_directive("model", Model)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
