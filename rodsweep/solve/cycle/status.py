"""How the search for a limit cycle ended: the sentence that the user reads for each outcome."""

from ..status import PointStatus


class CycleStatus(PointStatus):
    """Outcome of a point of the task limit_cycle; it succeeded where the rod's fate is known."""

    cycle = (
        0,
        "the rod beats: the cycle closes, and no sooner, all its Floquet multipliers lie inside the circle, "
        "and its period and largest y are as accurate as asked for",
        True,
    )
    straight = 1, "the rod is straight again, and stays so: nothing beats from this start", True
    not_settled = (
        2,
        "no stable cycle was found within the periods allowed, or not to the accuracy asked for, as its "
        "errors say; raise the periods allowed, start from a neighbour's cycle, or ask for a lower accuracy",
    )
    left_the_model = (
        3,
        "the rod was crushed somewhere (h1 <= 0), where the model ends; start from a smaller amplitude or "
        "from a neighbour's cycle, or lower F or raise k1",
    )
    failed = 4, "the integration failed and nothing is stored; the message says why"
    unstable = (
        5,
        "the rod can beat so, but leaves this cycle at the least disturbance: a Floquet multiplier lies "
        "outside the circle",
        True,
    )
    torus = (
        6,
        "the rod beats for ever without repeating: the cycle there is unstable by a complex pair of Floquet "
        "multipliers, and the motion goes round it with a second frequency, as the message says; the "
        "multipliers are those of the cycle, and nothing else of it is stored",
        True,
    )


class MarchedStatus(PointStatus):
    """Outcome of a point of the task limit_cycle with `method: integration`."""

    cycle = (
        0,
        "the rod beats: its motion repeats, and its period and largest y are as accurate as asked for; no "
        "Floquet multipliers are computed",
        True,
    )
    straight = 1, "the motion has decayed to rounding: nothing beats from this start", True
    not_settled = (
        2,
        "the motion does not repeat within the periods allowed, or not to the accuracy asked for, as its "
        "errors say; raise the periods allowed, ask for a lower accuracy, or use `method: collocation`",
    )
    left_the_model = (
        3,
        "the rod was crushed somewhere (h1 <= 0), where the model ends; start from a smaller amplitude, or "
        "lower F or raise k1",
    )
    failed = 4, "the integration failed and nothing is stored; the message says why"
