"""Status of the outcomes of all tasks, with a sentence for the user."""

from enum import IntEnum
from typing import Self


class PointStatus(IntEnum):
    """Outcome of a point; the value is what the result file stores, the name its flag meaning.

    A member is (value, sentence) or, where the point ended as it should, (value, sentence, True).
    """

    sentence: str
    """Cause and remedy."""
    succeeded: bool

    def __new__(cls, value: int, sentence: str, succeeded: bool = False) -> Self:
        member = int.__new__(cls, value)
        member._value_ = value
        member.sentence = sentence
        member.succeeded = succeeded
        return member
