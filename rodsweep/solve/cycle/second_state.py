"""Second stable state of a rod, in addition to the final state of its motion.

If the straight rod is stable and the final state is a different state, the rod has two stable states. If the
final state is the straight rod, a nearby subcritical Hopf point makes a second stable state possible, but
does not prove this state.
"""

from enum import IntEnum
from math import nan

from ...model.rod import Rod
from ..hopf.subcritical_hopf import SubcriticalHopf, subcritical_hopf_near
from ..point_outcome import FAILURE_EXCEPTIONS
from ..status import PointStatus
from .status import CycleStatus


class SecondStableState(IntEnum):
    """Second stable state of a rod, as far as known; the result file stores the value. not_known: the search
    failed, or the stability of the straight rod is not known. none_known: no second stable state is known.
    straight: the straight rod. cycle_possible: a cycle may exist, because a subcritical Hopf point is
    near."""

    not_known = -1
    none_known = 0
    straight = 1
    cycle_possible = 2


def second_state_force_and_message(
    rod: Rod, status: PointStatus, is_straight_stable: bool | None
) -> tuple[SecondStableState, float, str]:
    """Returns (state, F, message). state: second stable state of the rod. F: force of a subcritical Hopf
    point, in k3/L^2, or NaN. message: for the user, or "".

    status: outcome of the motion or of the search for a cycle. is_straight_stable: whether the straight rod
    is stable; None if not known.
    """
    if status == CycleStatus.failed or is_straight_stable is None:
        return SecondStableState.not_known, nan, ""
    if not is_straight_stable:
        return SecondStableState.none_known, nan, ""
    if status != CycleStatus.straight:
        return SecondStableState.straight, nan, "the straight rod is stable as well"
    try:
        hopf = subcritical_hopf_near(rod)
    except FAILURE_EXCEPTIONS:
        return SecondStableState.not_known, nan, ""
    if hopf is None:
        return SecondStableState.none_known, nan, ""
    return SecondStableState.cycle_possible, hopf.F, _second_state_sentence(hopf)


def _second_state_sentence(hopf: SubcriticalHopf) -> str:
    return (
        f"the Hopf point at F = {hopf.F:.9g} is subcritical: an unstable cycle exists, with a largest y of "
        f"about {hopf.unstable_cycle_y:.2g} L by the normal form, and from a start at larger y the rod may "
        "reach a stable cycle; the task `branch` follows the branch of these cycles"
    )
