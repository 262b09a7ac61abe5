"""Base class of the status codes of all tasks. Each code has a sentence for the user."""

from enum import IntEnum
from typing import Self


class PointStatus(IntEnum):
    """Status of one point of a sweep. The result file stores the integer, and the names as flag meanings.

    A member is defined as (value, sentence), or as (value, sentence, True) if the status means success.
    """

    sentence: str
    """Cause of the status and remedy, for the user."""
    succeeded: bool
    """Whether the status means success: the results of the point are complete."""

    def __new__(cls, value: int, sentence: str, succeeded: bool = False) -> Self:
        member = int.__new__(cls, value)
        member._value_ = value
        member.sentence = sentence
        member.succeeded = succeeded
        return member
