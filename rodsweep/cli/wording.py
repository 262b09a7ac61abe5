"""Words that the command line uses in more than one place."""


def counted(count: int, noun: str) -> str:
    """A number of things whose plural ends in s."""
    return f"{count} {noun}" if count == 1 else f"{count} {noun}s"
