"""The page that `rodsweep show` prints, and how its numbers are read and held against true ones.

A page remembers which of its numbers were read: what is left over was compared with nothing.
"""

import contextlib
import io
import os
import re
from math import inf

import numpy as np

from rodsweep.post.summary import show_summary

NUMBER = r"-?\d+(?:\.\d+)?(?:e[+-]\d+)?"
IN_SIGHT = re.compile(rf"(?<![\w^*/:.+-])({NUMBER})(?![\w^/:]|\.\d)")
"""A number that is said, not one in the name of a parameter or a unit."""
TIE = 1e-12
"""Relative difference of two numbers that rounding sets apart."""
BOOKKEEPING = (
    "computed ",
    "BLAS: ",
    "time per",
    "time of the",
    "cost of a search",
    "unknowns of the mesh",
    "no mesh is stored",
    "last run",
    "the ranks were busy",
    "the rank was busy",
    "parameter ",
    "status ",
)
"""How lines begin that say by what and how fast a file was computed, and heads of tables."""
WIDEST = "500"
"""Columns of the terminal, so that no cell of a table is broken into lines."""


class Page(list):
    """The lines of a page but for the first."""

    def __init__(self, text):
        super().__init__(line.rstrip() for line in text.splitlines()[1:] if line.strip())
        self.seen = {line: set() for line in self}

    def mark(self, line, span):
        """A part of a line was read."""
        self.seen[line].add(span)

    def unread(self):
        """(line, its numbers that nothing read) of every line that says some."""
        found = []
        for line in self:
            if line.startswith(BOOKKEEPING):
                continue
            left = [
                match[1]
                for match in IN_SIGHT.finditer(line)
                if not any(a <= match.start(1) and match.end(1) <= b for a, b in self.seen[line])
            ]
            found += [(line, left)] if left else []
        return found


def regions(page, before, mask, columns, of_arms=None):
    """The check of how many points do something, NUMBER in brackets behind words, and where these lie.

    of_arms: why an arm's quantities are not those of a mask, from what the brackets hold and the mask.
    """
    found = []
    for line, match in read(page, rf"{before} NUMBER(?: \(([^()]*)\))?(?=[,;.]|$)"):
        why = [] if int(match[1]) == mask.sum() else [f"it is {mask.sum()} points"]
        for item in re.finditer(rf"(\w+) = ({NUMBER}(?: to {NUMBER})?)?(?: and )?(inf)?", match[2] or ""):
            values = columns[item[1]][mask]
            why += [] if (item[3] is not None) == bool(np.isinf(values).any()) else ["inf is there or not"]
            why += [range_as_stated(item[2], values)] if item[2] else []
        if match[2] and "=" not in match[2]:
            why.append(of_arms(match[2], mask))
        found.append((line, "; ".join(filter(None, why))))
    return found


def page_of(view):
    """What `rodsweep show` prints of a file."""
    out, before = io.StringIO(), os.environ.get("COLUMNS")
    os.environ["COLUMNS"] = WIDEST
    try:
        with contextlib.redirect_stdout(out):
            show_summary(view)
    finally:
        os.environ.pop("COLUMNS")
        os.environ |= {"COLUMNS": before} if before else {}
    return Page(out.getvalue())


def read(page, pattern, only=None):
    """(line, match) of every line, or of one, with a pattern in which RANGE and NUMBER stand for theirs."""
    number = f"({NUMBER}(?: to {NUMBER})?|none)"
    whole = re.compile(pattern.replace("RANGE", number).replace("NUMBER", f"({NUMBER})"))
    found = [(line, match) for line in (page if only is None else [only]) for match in whole.finditer(line)]
    for line, match in found:
        for group in range(1, len(match.groups()) + 1):
            page.mark(line, match.span(group))
    return found


def parameter_lines(page, name, values):
    """(line, why its number of values is wrong, smallest, largest as text, unit) of a parameter's row.

    A row has one number where there is one value. Where every row has, their number is not said.
    """
    several = len({f"{x:.9g}" for x in np.unique(values)})
    end = f"({NUMBER}|inf)"
    counted = "NUMBER +" * any(re.match("parameter +values", line) is not None for line in page)
    for line, match in read(page, rf"^{name} +{counted}{end}{f' +{end}' * (several > 1)} +(\S.*)$"):
        *numbers, unit = match.groups()
        wrong = counted and int(numbers.pop(0)) != several
        yield line, f"{several} values" * bool(wrong), numbers[0], numbers[-1], unit


def unit_of(text):
    """The unit of the last digit of a number that is written."""
    mantissa, _, exponent = text.partition("e")
    decimals = len(mantissa.partition(".")[2])
    if not decimals and not exponent:  # 1200 may have been rounded to hundreds
        decimals = -(len(mantissa) - len(mantissa.rstrip("0"))) if float(text) else 0
    return 10.0 ** (int(exponent or 0) - decimals)


def as_stated(text, true, slack=0.0):
    """Why a number that stands without an error is not the true one; empty where it is.

    slack: the error of the true one, absolute.
    """
    off = abs(float(text) - true)
    return "" if off <= unit_of(text) + TIE * abs(true) + slack else f"{text} is {true!r}"


def range_as_stated(text, true):
    """Why a range, or a number, is not that of the true values, an array."""
    ends = text.split(" to ")
    true = np.asarray(true, float)
    true = true[np.isfinite(true)]
    if text == "none" or not true.size:
        return "" if text == "none" and not true.size else f"{text} of {true}"
    return "; ".join(filter(None, (as_stated(ends[0], true.min()), as_stated(ends[-1], true.max()))))


def ranges(page, pattern, *true):
    """The check of the ranges in a pattern against arrays of true values, one a range."""
    return [
        (line, "; ".join(filter(None, map(range_as_stated, match.groups(), true))))
        for line, match in read(page, pattern)
    ]


def counts(page, pattern, *true):
    """The check of whole numbers in a pattern against the true ones."""
    return [
        (line, "" if list(map(int, match.groups())) == list(map(int, true)) else f"it is {true}")
        for line, match in read(page, pattern)
    ]


def with_error(text, error, true):
    """Why a number with its error excludes the true one."""
    off = abs(float(text) - true)
    return "" if off <= float(error) + TIE * abs(true) else f"{text} +- {error} is {true!r}"


def at_most(page, pattern, *true):
    """The check of largest errors that a pattern states, against the errors that there are."""
    return [
        (
            line,
            "; ".join(
                f"an error of {error:.3g} is above {said}"
                for said, error in zip(match.groups(), true, strict=True)
                if error > float(said) * (1 + 0.05) + TIE  # one or two digits are given
            ),
        )
        for line, match in read(page, pattern)
    ]


def relative(found, true):
    """The largest relative difference of two arrays of one shape, over what both have."""
    found, true = np.asarray(found, float), np.asarray(true, float)
    there = np.isfinite(found) & np.isfinite(true)
    if not there.any():
        return 0.0
    return float(np.max(np.abs(found - true)[there] / np.where(true[there] == 0, inf, np.abs(true[there]))))
