"""What the file of the task branch holds: the cycles of all branches of a rod, and their special points."""

from typing import Any

from ...model.parameters import NONLINEAR_PARAMETERS, PARAMETERS, all_but
from .variables import ANEW, SECONDS, STATUS, Increase, Layout, Variable, real, truth, whole, word

ALONG, SPECIAL = "branch_point", "special"

SPECIAL_MEANINGS = {
    "none": "no special point: the list is longer than what was found",
    "hopf": "a Hopf point, where cycles are born: here a branch begins or ends",
    "fold": "the branch turns back in the parameter; a multiplier is 1",
    "torus": "a complex pair of multipliers crosses the circle: a motion with two frequencies is born",
    "symmetry_breaking": "a multiplier is 1; a branch of cycles without the mirror symmetry begins or ends",
    "left_the_model": "h1 reaches 0 somewhere on the cycle, where the model ends",
    "end": "the branch ends here for the reason that special_reason says",
    "period_doubling": "a multiplier of a cycle without the symmetry is -1; cycles of twice the period begin",
}
"""What happens at a special point; the place in this list is what the file stores."""
SPECIAL_KINDS = tuple(SPECIAL_MEANINGS)
END_REASONS = ("none", "range_end", "crushed", "no_cycle_found", "list_full")
"""Why a branch ends at a point of the kind end."""

ERRORS = (
    ("period_error", "the relative error of period"),
    ("amplitude_error", "the relative error of tip_y_max"),
    ("extrema_error", "the error of the other extrema, in units of tip_y_max"),
    ("multiplier_error", "the absolute error of multiplier"),
)
"""Names of the errors of a cycle, and of what; all hold at the stored value of the parameter."""


def followed_variables(along: str) -> tuple[Variable, ...]:
    """The cycles of all branches, one branch after another."""
    unit = PARAMETERS[along].unit
    return (
        whole("branch", "number of the branch, from 1", ALONG),
        real(f"branch_{along}", unit, f"{along} of the cycle", ALONG),
        real(
            f"branch_{along}_error",
            "1",
            f"estimate of the relative error of branch_{along}, where the moment at the clamp is the same",
            ALONG,
        ),
        real("period", "tau2", "period of the cycle", ALONG),
        real("tip_y_max", "L", "largest y of the tip", ALONG),
        real("tip_y_min", "L", "smallest y of the tip; -tip_y_max where the cycle has the symmetry", ALONG),
        real("tip_x_min", "L", "smallest x of the tip", ALONG),
        real("tip_x_max", "L", "largest x of the tip", ALONG),
        real("tip_theta_max", "1", "largest angle of the tip", ALONG),
        real("least_stretch", "1", "smallest h1 on the cycle; the model holds while it is positive", ALONG),
        real("multiplier", "1", "modulus of the largest Floquet multiplier but the trivial one", ALONG),
        whole(
            "unstable_multipliers",
            "Floquet multipliers outside the circle; 0 is stable; -1: one is on it within its error",
            ALONG,
        ),
        *(real(name, "1", f"estimate of {error}, at branch_{along}", ALONG) for name, error in ERRORS),
    )


def special_variables(along: str) -> tuple[Variable, ...]:
    """The special points of all branches, one branch after another."""
    unit = PARAMETERS[along].unit
    return (
        word("special_kind", "what happens at the special point", SPECIAL_KINDS, SPECIAL),
        real("special_at", unit, f"{along} at the special point", SPECIAL),
        real("special_error", unit, "estimate of the absolute error of special_at", SPECIAL),
        real("special_period", "tau2", "period of the cycle there", SPECIAL),
        real("special_tip_y_max", "L", "largest y of the tip there; 0 at a Hopf point", SPECIAL),
        real(
            "special_amplitude_coefficient",
            "L",
            "a of a Hopf point: next to it the largest y is "
            f"|a| sqrt(|{along}/special_at - 1|), a < 0 where the cycles are at smaller {along}",
            SPECIAL,
        ),
        *(
            real(f"special_{name}_error", "1", f"estimate of the relative error of special_{name}", SPECIAL)
            for name in ("period", "tip_y_max", "amplitude_coefficient")
        ),
        whole("special_branch", "number of the branch, from 1", SPECIAL),
        whole(
            "special_point",
            "branch_point, from 1, behind which it lies on its branch; 0: before the first cycle of it",
            SPECIAL,
        ),
        word("special_reason", "why the branch ends there", END_REASONS, SPECIAL),
        whole(
            "special_meets",
            "at a symmetry breaking, number of the other branch that begins or ends there; -1: none",
            SPECIAL,
        ),
        whole(
            "special_unstable_after",
            "at a Hopf point, unstable modes of the straight rod beyond it in the parameter",
            SPECIAL,
        ),
    )


def _has(name: str) -> Increase:
    """A list that has room left needs no longer one."""
    return Increase(lambda records, before: records[name] < before)


INCREASES = {"cycles": _has("point_count"), "special": _has("special_count"), "certify": ANEW}


def layout(config: dict[str, Any]) -> Layout:
    """The layout that a resolved config asks for."""
    options = config["branch"]
    along = options["along"]
    variables = (
        whole("hopf_count", f"Hopf points found between start and stop of {along}"),
        whole("branch_count", "branches that begin at them, or where the symmetry of one breaks, each once"),
        whole("point_count", "cycles of all branches"),
        whole("special_count", "special points of all branches, stored or not"),
        whole("unstable_at_start", "unstable modes of the straight rod at start; -1: not known"),
        truth("certified", "whether it is proved that no Hopf point is missing"),
        *followed_variables(along),
        *special_variables(along),
        SECONDS,
        STATUS,
    )
    parameters = all_but(along, NONLINEAR_PARAMETERS)
    return Layout(variables, {ALONG: options["cycles"], SPECIAL: options["special"]}, parameters)
