"""Counts, plurals, durations and rounded numbers in words, for the command line and `show`."""

from collections.abc import Sequence

SIBILANT_ENDINGS = ("s", "x", "z", "ch", "sh")
"""Endings of nouns whose plural ends in "es"."""

SHORTEST_DURATION_WRITTEN_IN_SECONDS = 0.9995
"""`duration` writes durations of at least this many seconds in seconds; in milliseconds, three digits would
round such a duration to 1000 ms or more."""


def counted(count: int, noun: str) -> str:
    """`count` followed by `noun` in its singular or plural: "1 branch", "2 branches". If the noun has several
    words, the last word gets the plural ending.
    """
    return f"{int(count)} {noun if count == 1 else plural(noun)}"


def plural(noun: str) -> str:
    """The plural of a regular noun."""
    if noun.endswith(SIBILANT_ENDINGS):
        return f"{noun}es"
    return f"{noun[:-1]}ies" if noun.endswith("y") and noun[-2] not in "aeiou" else f"{noun}s"


def is_or_are(count: int) -> str:
    """ "is" if count == 1, else "are"."""
    return "is" if count == 1 else "are"


def has_or_have(count: int) -> str:
    """ "has" if count == 1, else "have"."""
    return "has" if count == 1 else "have"


def count_of_total(count: int, total: int, noun: str) -> str:
    """`count` out of the total `total`, with the noun: `count_of_total(2, 4, "row")` is "2 of 4 rows"."""
    return f"{int(count)} of {counted(total, noun)}"


def enumeration(parts: Sequence[str], conjunction: str = "and") -> str:
    """The parts as an enumeration, `conjunction` before the last: `enumeration(["a", "b", "c"])` is "a, b and
    c"; empty without parts."""
    return f" {conjunction} ".join(filter(None, [", ".join(parts[:-1]), *parts[-1:]]))


def duration(seconds: float) -> str:
    """A duration with three digits: in milliseconds below one second, else in seconds."""
    return f"{1e3 * seconds:.3g} ms" if seconds < SHORTEST_DURATION_WRITTEN_IN_SECONDS else f"{seconds:.3g} s"


def two_significant_digits(value: float) -> str:
    """`value` as text with two significant digits; with an exponent only from a million and below 1e-4."""
    return f"{float(f'{value:.2g}'):g}"
