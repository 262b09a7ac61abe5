"""Message on a motion in which no period was found."""

from collections.abc import Sequence

from ....arrays import Array
from ....wording import counted
from .returns import RETURN_SETTINGS, recurrence


def no_period_text(return_count: int, limit_text: str, last_returns: Sequence[tuple[float, Array]]) -> str:
    """Message on a motion in which no period was found; says so if the motion almost repeats at its last
    returns.

    return_count: number of returns of the tip. limit_text: clause on another limit that was reached, or
    empty. last_returns: time and bending moments, (nodes,), of each of the last returns.
    """
    text = f"no periodic motion within {counted(return_count, 'return')} of the tip{limit_text}"
    moments = [state for _, state in last_returns][-1 - RETURN_SETTINGS.max_returns_per_period :]
    if len(moments) < 2:
        return text
    _, distance = recurrence(moments)
    if distance >= RETURN_SETTINGS.max_equal_return_distance:
        return text
    return (
        f"{text}, but the last returns differ by a relative {distance:.1e} only: the motion changes slowly, "
        "as near a fold of a branch of cycles, which the task `branch` follows"
    )


def decayed_without_end_text(return_count: int, is_unstable: bool) -> str:
    """Message on a motion whose deflection has decayed without an end at the straight rod. return_count:
    number of returns of the tip. is_unstable: whether the straight rod is unstable."""
    reason = "the straight rod is unstable" if is_unstable else "the stretch of the rod has not relaxed"
    return f"the deflection has decayed after {return_count} returns, but {reason}"
