"""Counts, plurals and durations in words, for the command line and `show`."""

SIBILANT_ENDINGS = ("s", "x", "z", "ch", "sh")
"""Endings of nouns whose plural ends in "es"."""

LONGEST_IN_MS = 0.9995
"""Duration in seconds from which `duration` writes seconds: three digits round a longer one to 1000 ms."""


def counted(count: int, noun: str) -> str:
    """A count with its noun: "1 branch", "2 branches". Of a noun of several words the last word becomes
    plural.
    """
    return f"{int(count)} {noun if count == 1 else plural(noun)}"


def plural(noun: str) -> str:
    """The plural of a regular noun."""
    if noun.endswith(SIBILANT_ENDINGS):
        return f"{noun}es"
    return f"{noun[:-1]}ies" if noun.endswith("y") and noun[-2] not in "aeiou" else f"{noun}s"


def is_or_are(count: int) -> str:
    """ "is" for a count of one, else "are"."""
    return "is" if count == 1 else "are"


def has_or_have(count: int) -> str:
    """ "has" for a count of one, else "have"."""
    return "has" if count == 1 else "have"


def some_of(count: int, whole: int, noun: str) -> str:
    """A count out of a total with its noun: `some_of(2, 4, "row")` is "2 of 4 rows"."""
    return f"{int(count)} of {counted(whole, noun)}"


def duration(seconds: float) -> str:
    """A duration with three digits: in milliseconds below one second, else in seconds."""
    return f"{1e3 * seconds:.3g} ms" if seconds < LONGEST_IN_MS else f"{seconds:.3g} s"
