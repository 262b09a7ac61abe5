"""Second stable state of a rod, besides the final state of its motion.

If the straight rod is stable and the final state is a different state, the rod has two stable states. If the
final state is the straight rod, a nearby subcritical Hopf point makes a second state possible, but does not
prove it.
"""

from enum import IntEnum
from math import nan

from ...model.rod import Rod
from ..hopf.subcritical_hopf import SubcriticalHopf, subcritical_hopf_near
from ..point import FAILURES
from ..status import PointStatus
from .status import CycleStatus


class SecondState(IntEnum):
    """Knowledge about a second stable state of a rod; the result file stores the value."""

    not_known = -1
    none_known = 0
    straight = 1
    cycle_possible = 2


def second_state(rod: Rod, status: PointStatus, stable: bool | None) -> tuple[SecondState, float, str]:
    """(second stable state of a rod, force of the subcritical Hopf point or NaN, message or "").

    status: outcome of the motion or search for a cycle. stable: whether the straight rod is stable; None if
    this is not known.
    """
    if status == CycleStatus.failed or stable is None:
        return SecondState.not_known, nan, ""
    if not stable:
        return SecondState.none_known, nan, ""
    if status != CycleStatus.straight:
        return SecondState.straight, nan, "the straight rod is stable as well"
    try:
        beside = subcritical_hopf_near(rod)
    except FAILURES:
        return SecondState.not_known, nan, ""
    if beside is None:
        return SecondState.none_known, nan, ""
    return SecondState.cycle_possible, beside.F, _sentence(beside)


def _sentence(beside: SubcriticalHopf) -> str:
    return (
        f"the Hopf point at F = {beside.F:.9g} is subcritical: from a start beyond its unstable cycle, whose "
        f"largest y is about {beside.unstable_y:.2g} L by the normal form, the rod may reach a stable cycle; "
        "task `branch` follows this cycle"
    )
