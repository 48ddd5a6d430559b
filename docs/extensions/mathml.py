"""Formulas as MathML, by the converter of docutils: pages need no script and no font for them.

An unknown LaTeX command is an error of the build, with the formula. Three things are set as LaTeX
sets them: the space around a function's name, upright words as subscripts, and bars of one height.
"""

from __future__ import annotations

import re
from typing import Any
from xml.etree import ElementTree

from docutils import nodes
from docutils.utils.math import MathError
from docutils.utils.math.latex2mathml import tex2mathml
from sphinx.util import logging

_log = logging.getLogger(__name__)
NAMESPACE = "http://www.w3.org/1998/Math/MathML"
APPLY = "\u2061"
"""The sign between a function and its argument; it has no width."""
FUNCTIONS = {
    "arccos", "arcsin", "arctan", "cos", "cosh", "cot", "coth", "det", "exp", "Im", "ln", "log",
    "Re", "sgn", "sin", "sinh", "softplus", "tan", "tanh",
}  # fmt: skip
NO_SPACE = {"(", "[", ")", "]", ",", "=", "+", "−"}
"""Signs beside which a function's name needs no space."""
SHORT_WORDS = {"cr", "fr", "hi", "in", "lo", "sc", "up"}
"""Subscripts of two letters that are words; all others are pairs of indices."""


def spaced(mathml: str) -> str:
    """MathML of docutils with spaces around functions, upright words, and equal bars."""
    root = ElementTree.fromstring(
        mathml.replace("&ApplyFunction;", APPLY).replace(f' xmlns="{NAMESPACE}"', "")
    )
    for parent in list(root.iter()):
        if parent.tag in ("msub", "msubsup"):
            _upright(parent[1])
        _bars(parent)
        _functions(parent)
    return ElementTree.tostring(root, encoding="unicode")


def _upright(subscript: ElementTree.Element) -> None:
    """One upright word in place of the product of its letters."""
    letters = [(child.text or "") if child.tag == "mi" else "" for child in subscript]
    word = "".join(letters)
    if all(re.fullmatch("[a-z]", x) for x in letters) and (len(word) > 2 or word in SHORT_WORDS):
        for child in list(subscript):
            subscript.remove(child)
        ElementTree.SubElement(subscript, "mi").text = word


def _bars(parent: ElementTree.Element) -> None:
    """Both bars of an absolute value as fences that do not stretch."""
    opened = 0
    for child in parent:
        bar = child[0] if child.tag in ("msup", "msub") and len(child) else child
        if bar.tag != "mo" or bar.text != "|":
            continue
        opens = bar.get("class") == "mathopen"
        if opens or opened:
            bar.attrib.update(form="prefix" if opens else "postfix", stretchy="false")
            bar.attrib.update(lspace="0", rspace="0")
            opened += 1 if opens else -1


def _functions(parent: ElementTree.Element) -> None:
    """A thin space before a function's name and before an argument without brackets."""
    if parent.tag not in ("math", "mrow", "mtd", "mstyle"):
        return
    old = [child for child in parent if child.text != APPLY]
    for before, name, after in zip([None, *old], old, [*old[1:], None], strict=False):
        power = name[0] if name.tag in ("msup", "msub", "msubsup") else name
        if power.tag != "mi" or power.text not in FUNCTIONS:
            continue
        if before is not None and (before.tag not in ("mo", "mspace") or before.text in (")", "]")):
            parent.insert(list(parent).index(name), _thin())
        if after is not None and not (after.tag == "mspace" or after.text in NO_SPACE):
            parent.insert(list(parent).index(after), _thin())


def _thin() -> ElementTree.Element:
    return ElementTree.Element("mspace", width="0.1667em")


def _converted(node: nodes.Element, *, block: bool) -> str:
    try:
        return spaced(str(tex2mathml(node.astext(), as_block=block)))
    except MathError as fault:
        _log.warning("formula %r: %s", node.astext(), fault, location=node)
        return ""


def _inline(self: Any, node: nodes.Element) -> None:
    self.body.append(_converted(node, block=False))
    raise nodes.SkipNode


def _displayed(self: Any, node: nodes.Element) -> None:
    self.body.append(self.starttag(node, "div", CLASS="math"))
    self.body.append(_converted(node, block=True))
    self.body.append("</div>")
    raise nodes.SkipNode


def setup(app: Any) -> dict[str, bool]:
    """Register the renderer `mathml`."""
    app.add_html_math_renderer("mathml", (_inline, None), (_displayed, None))
    return {"parallel_read_safe": True, "parallel_write_safe": True}
