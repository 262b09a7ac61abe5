"""Status values of the task limit_cycle, each with a sentence for the user."""

from ..status import PointStatus


class CycleStatus(PointStatus):
    """Status of a point of the task limit_cycle with `method: collocation`. A status is a success if the
    final state of the rod is known."""

    cycle = (
        0,
        "stable limit cycle in the plane: the minimal period is confirmed, all nontrivial Floquet "
        "multipliers lie inside the unit circle, and period and largest y are as accurate as requested",
        True,
    )
    straight = 1, "the rod returns to the straight state, which is stable", True
    not_settled = (
        2,
        "no stable cycle was found within the allowed periods, or the errors of the cycle exceed the "
        "requested accuracy; raise the allowed periods, start from a neighbour's cycle, or use a "
        "larger number for the accuracy",
    )
    left_the_model = (
        3,
        "a cross-section of the rod was crushed (h1 <= 0) or lost its stiffness, so the model ends there; "
        "start from a smaller amplitude or from a neighbour's cycle, lower F, or raise k1",
    )
    failed = (
        4,
        "the solve failed and nothing is stored; the message says why; try another accuracy or start, or "
        "move a parameter slightly",
    )
    unstable = (
        5,
        "unstable limit cycle: a Floquet multiplier lies outside the unit circle, so the rod leaves "
        "this cycle after any disturbance",
        True,
    )
    torus = (
        6,
        "quasiperiodic motion on a torus: the cycle inside the torus is unstable by a complex pair of "
        "Floquet multipliers, and the motion has a second frequency, given by modulation_ratio; only the "
        "multipliers of this cycle are stored",
        True,
    )


class IntegratedCycleStatus(PointStatus):
    """Status of a point of the task limit_cycle with `method: integration`."""

    cycle = (
        0,
        "limit cycle: the motion repeats, and period and largest y are as accurate as requested; no Floquet "
        "multipliers are computed",
        True,
    )
    straight = 1, "the motion has decayed to rounding error: the rod returns to the straight state", True
    not_settled = (
        2,
        "the motion does not repeat within the allowed periods, or the errors of the cycle exceed the "
        "requested accuracy; raise the allowed periods, use a larger number for the accuracy, or "
        "`method: collocation`",
    )
    left_the_model = (
        3,
        "a cross-section of the rod was crushed (h1 <= 0) or lost its stiffness, so the model ends there; "
        "start from a smaller amplitude, lower F, or raise k1",
    )
    failed = (
        4,
        "the integration failed and nothing is stored; the message says why; try another accuracy, or move "
        "a parameter slightly",
    )
