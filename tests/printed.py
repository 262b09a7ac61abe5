"""Layout of printed answers and tables: widths, aligned columns, digits by errors."""

import re
from math import floor, log10

import numpy as np

WINDOW = 80
"""Width of the window, in characters."""
MOST_LINES = 12
"""Largest number of lines of an answer at a prompt, besides further lines of its folded heading."""
ROUNDING = 1e-9
"""Below this a number on a page is an estimate of rounding, of which only the size is alike elsewhere."""
NUMBER = re.compile(r"[-+]?(?:\d+\.?\d*(?:e[-+]?\d+)?|inf)")
ERRORS = {
    "growth_rate": ("error_estimate", False),
    "crossing_F": ("crossing_error", False),
    "crossing_frequency": ("crossing_frequency_error", False),
    "special_at": ("special_error", False),
    "multiplier": ("multiplier_error", False),
    "numerical_abscissa": ("abscissa_error", False),
    "period": ("period_error", True),
    "tip_y_max": ("amplitude_error", True),
    "condition": ("condition_error", True),
    "amplitude_coefficient": ("amplitude_coefficient_error", True),
}
"""Variables with an error of their own: its name, and whether it is relative."""


def blocks_of(text):
    """Blocks of the lists of a whole table: (names, start of every column, lines below names and units)."""
    lines = text.splitlines()
    for place, line in enumerate(lines):
        heads = list(re.finditer(r"\S+", line))
        listed = place and re.match(r"[a-z_]+ *$|[a-z_]+(  +[a-z_0-9F]+)+$", line) and len(heads) > 1
        if not listed:
            continue
        rows = []
        for row in lines[place + 1 :]:
            if not row:
                break
            rows.append(row)
        starts = [head.start() for head in heads]
        rows = rows[1:] if rows and not rows[0][:1].strip() else rows
        yield [head[0] for head in heads], starts, rows


def cells_of(starts, row):
    """Cells of a row as printed, with the spaces around them."""
    ends = [*starts[1:], max(len(row), starts[-1])]
    return [row[start:end] for start, end in zip(starts, ends, strict=True)]


def unit_of(text):
    """Unit of the last printed digit of a number; zeros at the end of a whole number may be rounded."""
    mantissa, _, exponent = text.partition("e")
    whole, _, decimals = mantissa.partition(".")
    zeros = len(whole) - len(whole.rstrip("0")) if not decimals and not exponent else 0
    return 10.0 ** (int(exponent or 0) - len(decimals) + zeros)


def flaws_of_layout(answer):
    """What is wrong with the layout of an answer and of its table, each in words."""
    brief, whole = repr(answer), repr(answer.table())
    for line in (*brief.splitlines(), *whole.splitlines()):
        if len(line) > WINDOW:
            yield f"{len(line)} characters in {line!r}"
    heading = 1 + len(answer.rod) // 70 + len(answer.sentence + answer.message) // 70
    if len(brief.splitlines()) > MOST_LINES + heading:
        yield f"{len(brief.splitlines())} lines: {brief}"
    if brief.startswith(("Rod(", "Arm(", answer.rod)):
        yield f"the first line is not the answer: {brief.splitlines()[0]!r}"
    yield from flaws_of_columns(whole)
    yield from flaws_of_digits(answer, whole)


def flaws_of_columns(whole):
    """Columns whose decimal points are not below each other."""
    for names, starts, rows in blocks_of(whole):
        for name, column in zip(
            names, zip(*(cells_of(starts, row) for row in rows), strict=True), strict=True
        ):
            cells = [cell for cell in column if cell.strip()]
            if not all(NUMBER.fullmatch(cell.strip()) for cell in cells):
                continue
            points = {re.search(r"[.e]|(?<=\S)(?=\s|$)", cell).start() for cell in cells}
            if len(points) > 1:
                yield f"the column {name} is not aligned: {cells}"


def flaws_of_digits(answer, whole):
    """Printed numbers of lists with digits beyond their errors, or away from the stored numbers."""
    for names, starts, rows in blocks_of(whole):
        for name in set(names) & ERRORS.keys():
            error, is_relative = ERRORS[name]
            values = np.atleast_1d(getattr(answer, name)) if name in answer.data else np.zeros(0)
            if error not in answer.data or len(values) != len(rows):
                continue
            printed = [cells_of(starts, row)[names.index(name)].strip() for row in rows]
            errors = np.atleast_1d(getattr(answer, error)) * (np.abs(values) if is_relative else 1.0)
            for text, value, known in zip(printed, values, errors, strict=True):
                if not text or not np.isfinite(value) or value == 0 or not known > 0:
                    continue
                unit = unit_of(text)
                if unit < 10.0 ** floor(log10(known)) * (1 - 1e-9):
                    yield f"{name} = {text} has digits beyond its error {known}"
                if abs(float(text) - value) > 0.51 * unit + 1e-14 * abs(value):
                    yield f"{name} = {text} is {value}"
