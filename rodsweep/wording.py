"""Numbers of things in words, as the command line and `show` write them."""

SIBILANTS = ("s", "x", "z", "ch", "sh")
"""Endings of a noun whose plural ends in es."""

LONGEST_IN_MS = 0.9995
"""Seconds, which three digits round to a second, from which on a time is given in these."""


def counted(count: int, noun: str) -> str:
    """A number of things: "1 branch", "2 branches"; a noun of several words ends in the one that changes."""
    return f"{int(count)} {noun if count == 1 else plural(noun)}"


def plural(noun: str) -> str:
    """The plural of a regular noun."""
    if noun.endswith(SIBILANTS):
        return f"{noun}es"
    return f"{noun[:-1]}ies" if noun.endswith("y") and noun[-2] not in "aeiou" else f"{noun}s"


def is_or_are(count: int) -> str:
    """The verb of a number of things."""
    return "is" if count == 1 else "are"


def has_or_have(count: int) -> str:
    """The verb of what a number of things have."""
    return "has" if count == 1 else "have"


def some_of(count: int, whole: int, noun: str) -> str:
    """So many of all things of a kind: "at " + some_of(2, 4, "row") is "at 2 of 4 rows"."""
    return f"{int(count)} of {counted(whole, noun)}"


def duration(seconds: float) -> str:
    """A time to three digits: in milliseconds below a second."""
    return f"{1e3 * seconds:.3g} ms" if seconds < LONGEST_IN_MS else f"{seconds:.3g} s"
