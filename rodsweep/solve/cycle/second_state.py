"""Whether a rod has another stable state than the one in which its point ended.

Where the straight rod is stable and the point ended elsewhere it has two for sure. Where the point ended at
the straight rod, a subcritical Hopf point next to it says that another is possible, and no more.
"""

from enum import IntEnum
from math import nan

from ...model.rod import Rod
from ..hopf.hopf_beside import SubcriticalHopf, subcritical_hopf_beside
from ..point import FAILURES
from ..status import PointStatus
from .status import CycleStatus


class SecondState(IntEnum):
    """What is known of a second stable state; the value is what the result file stores."""

    not_told = -1
    none_known = 0
    straight = 1
    cycle_possible = 2


def second_state(rod: Rod, status: PointStatus, stable: bool | None) -> tuple[SecondState, float, str]:
    """(what is known, force of the subcritical Hopf point or NaN, a sentence) of a point that ended so.

    stable: whether the straight rod is; None where it is not known.
    """
    if status == CycleStatus.failed or stable is None:
        return SecondState.not_told, nan, ""
    if not stable:
        return SecondState.none_known, nan, ""
    if status != CycleStatus.straight:
        return SecondState.straight, nan, "the straight rod is stable here too"
    try:
        beside = subcritical_hopf_beside(rod)
    except FAILURES:
        return SecondState.not_told, nan, ""
    if beside is None:
        return SecondState.none_known, nan, ""
    return SecondState.cycle_possible, beside.F, _sentence(beside)


def _sentence(beside: SubcriticalHopf) -> str:
    return (
        f"the Hopf point at F = {beside.F:.9g} is subcritical: from a start beyond its unstable cycle, whose "
        f"largest y is about {beside.unstable_y:.2g} L by its normal form, the rod may come to a stable "
        "cycle; the task branch follows it"
    )
