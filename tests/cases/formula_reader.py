"""Compute the formulas of a workbook from its cells, without the code that wrote them.

Of the language of spreadsheets what such a workbook needs: numbers, texts, cells and ranges,
arithmetic, comparisons, and a few functions.
"""

from __future__ import annotations

import re

_TOKEN = re.compile(
    r'\s*("(?:[^"]|"")*"|\$?[A-Z]+\$?\d+|[A-Z]+(?=\()|\d+\.?\d*|<=|>=|<>|[-+*/(),:=<>])'
)


class Workbook:
    """The cells of a workbook as read by openpyxl, formulas computed when asked."""

    def __init__(self, book):
        self.book = book

    def value(self, sheet, place):
        """The value of a cell, computed if it is a formula; text cells stay text."""
        cell = self.book[sheet][place.replace("$", "")]
        if cell.data_type != "f":
            return cell.value
        return _Formula(self, sheet, cell.value[1:]).result()


class _Formula:
    def __init__(self, book, sheet, text):
        self.book, self.sheet = book, sheet
        self.tokens, at = [], 0
        while at < len(text):
            found = _TOKEN.match(text, at)
            assert found, text[at:]
            self.tokens.append(found[1])
            at = found.end()
        self.at = 0

    def result(self):
        value = self.comparison()
        assert self.at == len(self.tokens), self.tokens[self.at :]
        return value

    def peek(self):
        return self.tokens[self.at] if self.at < len(self.tokens) else ""

    def take(self, expected=None):
        token = self.peek()
        assert expected is None or token == expected, (expected, token)
        self.at += 1
        return token

    def comparison(self):
        left = self.sum()
        while self.peek() in ("=", "<", ">", "<=", ">=", "<>"):
            sign, right = self.take(), self.sum()
            left = {
                "=": left == right, "<>": left != right, "<": left < right, ">": left > right,
                "<=": left <= right, ">=": left >= right,
            }[sign]  # fmt: skip
        return left

    def sum(self):
        left = self.product()
        while self.peek() in ("+", "-"):
            left = left + self.product() if self.take() == "+" else left - self.product()
        return left

    def product(self):
        left = self.signed()
        while self.peek() in ("*", "/"):
            left = left * self.signed() if self.take() == "*" else left / self.signed()
        return left

    def signed(self):
        if self.peek() == "-":
            self.take()
            return -self.signed()
        return self.single()

    def single(self):
        token = self.take()
        if token == "(":
            value = self.comparison()
            self.take(")")
            return value
        if token.startswith('"'):
            return token[1:-1].replace('""', '"')
        if token[0].isdigit():
            return float(token)
        if self.peek() == "(":
            return self.function(token)
        if self.peek() == ":":
            self.take()
            return self.range(token, self.take())
        return self.book.value(self.sheet, token)

    def range(self, first, last):
        cells = self.book.book[self.sheet][f"{first}:{last}".replace("$", "")]
        return [self.book.value(self.sheet, cell.coordinate) for row in cells for cell in row]

    def function(self, name):
        if name == "IF":
            return self.either()
        self.take("(")
        arguments = [self.comparison()]
        while self.peek() == ",":
            self.take()
            arguments.append(self.comparison())
        self.take(")")
        return {
            "ABS": lambda value: abs(value),
            "ISNUMBER": lambda value: isinstance(value, int | float),
            "SUM": lambda values: sum(v for v in values if isinstance(v, int | float)),
            "COUNTIF": lambda values, wanted: sum(v == wanted for v in values),
        }[name](*arguments)

    def either(self):
        """IF computes only the branch it takes."""
        self.take("(")
        chosen = self.comparison()
        self.take(",")
        values = []
        for wanted, end in ((True, ","), (False, ")")):
            if bool(chosen) is wanted:
                values.append(self.comparison())
            else:
                self.skip()
            self.take(end)
        return values[0]

    def skip(self):
        depth = 0
        while depth or self.peek() not in (",", ")"):
            depth += {"(": 1, ")": -1}.get(self.take(), 0)
