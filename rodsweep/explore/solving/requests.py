"""Requests of the page and the functions that answer them in a solver process. Answers are plain arrays.

The functions report progress to the page and never to the terminal, which all solver processes share.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from ...api.answers.answer import Answer
from ...api.answers.picture import plot
from ...api.arm import Arm
from ...api.dataset import view_of_dataset
from ...api.sweeping import sweep
from ...arrays import Array
from ...config.parameters_section import DEFAULT_VALUES_OF_PARAMETERS
from ...errors import InputError
from ...post.branch_curves import RodBranches, runs_of_equal_stability
from ..page_state import MATERIAL_SECTION_BY_LAW, PageState, dimensionless_parameters_of
from .diagram_curves_and_unstable_counts import DatasetOrArray, flag_words
from .diagrams import diagram_answer, diagram_answer_with_cycle_curves
from .dragged_tip import TipPosition, equilibrium_with_held_tip, motion_film_answer, released_motion_answer

AnswerVariables = dict[str, Any]
"""Variables of an answer, by name: arrays, and texts such as `status`, `sentence` and `message`."""
MODE_COUNT = 6
"""Number of eigenvalues in the picture of the spectrum."""
SHAPE_COUNT = 48
"""Number of shapes of the arm per period of a cycle; the browser interpolates between these shapes."""
GROWTH_FORCE_COUNT = 121
"""Number of forces at which growth rates are computed."""
MAX_GROWTH_TO_CRUSHING_FORCE_RATIO = 0.98
"""Largest force at which growth rates are computed, divided by the crushing force (zero stretch)."""


@dataclass(frozen=True)
class SolveRequest:
    """Request of a page to a solver process.

    kind: a key of `STATE_SOLVERS`, or of `TIP_SOLVERS` if `tip` is given. state: state of the page at the
    request. tip: position of the dragged tip, in L. stored_cycle: cycle from a result file; if given, its
    film is made without a solve.
    """

    kind: str
    state: PageState
    tip: TipPosition | None = None
    stored_cycle: DatasetOrArray | None = None


class Reply(NamedTuple):
    """Message of a solver process to the page.

    outcome: "answer", "refused", "failed" or "cancelled"; "ready" once the process has started; "progress"
    during a long solve. content: variables of the answer by name; for "progress", `text` and
    `completed_fraction` of a `SolvePosition`; for "refused" and "failed", an error message under the name
    `sentence`. seconds: time since the start of the solve.
    """

    outcome: str
    content: AnswerVariables
    seconds: float


def answer_variables(answer: Answer) -> AnswerVariables:
    """All variables of `answer` by name, and its `status`, `sentence` (meaning of the status), `message` and
    `units` (by variable)."""
    variables: AnswerVariables = {str(name): array.values for name, array in answer.data.variables.items()}
    return variables | {
        "status": str(answer.status), "sentence": answer.sentence, "message": answer.message,
        "units": answer.units,
    }  # fmt: skip


def thresholds_answer(state: PageState) -> AnswerVariables:
    """Thresholds of the straight rod along F, as variables by name. kinds: kind of each threshold, in
    words."""
    answer = state.rod_or_arm().thresholds(F_max=state.largest_force(), progress=False)
    return answer_variables(answer) | {"kinds": flag_words(answer.data["crossing_kind"]).tolist()}


def growth_answer(state: PageState) -> AnswerVariables:
    """Growth rates of the leading modes along F, as variables by name. F ends at the largest force, for
    linear material at most just below the crushing force (zero stretch). F: forces in k3/L^2, (n,).
    growth_rate: rates in `unit`, (n, modes). unit: "1/tau2" for a rod, "1/s" for an arm. unstable_count:
    numbers of unstable modes, (n,)."""
    rod_or_arm = state.rod_or_arm()
    tau2, unit = (rod_or_arm.tau2, "1/s") if isinstance(rod_or_arm, Arm) else (1.0, "1/tau2")
    rod = dimensionless_parameters_of(rod_or_arm)
    keywords: dict[str, Any] = {name: rod[name] for name in ("k1", "k2", "gamma3", "taper") if name in rod}
    keywords |= {"material": MATERIAL_SECTION_BY_LAW[state.law]} if MATERIAL_SECTION_BY_LAW[state.law] else {}
    F_max = state.largest_force()
    if state.law == "linear":
        F_max = min(F_max, MAX_GROWTH_TO_CRUSHING_FORCE_RATIO * crushing_force(rod))
    F = np.linspace(0, F_max, GROWTH_FORCE_COUNT)
    data = sweep("spectrum", F=F, **keywords, certify=False, progress=False)
    rates = data["growth_rate"].values.reshape(GROWTH_FORCE_COUNT, -1) / tau2
    count = data["unstable_count"].values.reshape(-1)
    return {"F": F, "growth_rate": rates, "unit": unit, "unstable_count": count}


def cycle_answer(state: PageState) -> AnswerVariables:
    """Limit cycle with shapes of the arm over a period. x, y: coordinates of the straight arm, whose tip the
    user can drag, in L, (nodes,) each."""
    cycle = state.rod_or_arm().cycle(shapes=SHAPE_COUNT, progress=False)
    return answer_variables(cycle) | equilibrium_with_held_tip(state, None)


def film_answer(state: PageState) -> AnswerVariables:
    """Film of the limit cycle, as made by `rodsweep plot`: the content of a GIF file, under the name `gif`.
    Raises InputError if the rod has no cycle."""
    answer = state.rod_or_arm().cycle(shapes=SHAPE_COUNT, progress=False)
    if not np.isfinite(answer.data["shape_x"].values).all():
        raise InputError(f"there is no cycle to film: {answer.sentence}")
    return film_of_cycle(answer)


def film_of_cycle(cycle: Answer | DatasetOrArray) -> AnswerVariables:
    """Film of a limit cycle: the content of a GIF file, under the name `gif`. cycle: result with shapes."""
    return {"gif": plot(cycle, what="animation").image}


def branch_answer(state: PageState) -> AnswerVariables:
    """Branches of cycles along F: the variables of `branch_answer_of_rod`, `status`, and `sentence`, the
    meaning of the status."""
    answer = state.rod_or_arm().branch(stop=state.largest_force(), progress=False)
    rod = RodBranches(view_of_dataset(answer.whole, Path(answer.rod)))
    branches = branch_answer_of_rod(rod, state.largest_force())
    return branches | {"status": str(answer.status), "sentence": answer.sentence}


def crushing_force(rod: Mapping[str, float]) -> float:
    """Force that crushes the thinnest section of a rod of linear material, in k3/L^2: k1 min(1, taper)^2.
    rod: parameters by name; a missing taper is 1."""
    return rod["k1"] * min(1.0, rod.get("taper", DEFAULT_VALUES_OF_PARAMETERS.get("taper", 1.0))) ** 2


STATE_SOLVERS: dict[str, Callable[[PageState], AnswerVariables]] = {
    "load": lambda state: {"F": dimensionless_parameters_of(state.rod_or_arm())["F"]},  # in k3/L^2
    "spectrum": lambda state: answer_variables(
        state.rod_or_arm().spectrum(modes=MODE_COUNT, vectors=True, progress=False)
    ),
    "thresholds": thresholds_answer,
    "growth": growth_answer,
    "cycle": cycle_answer,
    "branch": branch_answer,
    "diagram": diagram_answer,
    "cycles": diagram_answer_with_cycle_curves,
    "film": film_answer,
}
"""For each kind of request about the state of the page, the function that answers the request."""
TIP_SOLVERS: dict[str, Callable[[PageState, TipPosition], AnswerVariables]] = {
    "bent": equilibrium_with_held_tip,
    "motion": released_motion_answer,
    "film": motion_film_answer,
}
"""For each kind of request about a dragged tip, the function that answers the request."""


def answer_to(request: SolveRequest) -> AnswerVariables:
    """Answer to a request, as variables by name. Raises InputError for invalid values in the state of the
    page."""
    if request.stored_cycle is not None:
        return film_of_cycle(request.stored_cycle)
    if request.tip is not None:
        return TIP_SOLVERS[request.kind](request.state, request.tip)
    return STATE_SOLVERS[request.kind](request.state)


BranchPiece = tuple[Array, Array, int]
"""(F, largest y of the tip, stability) of a part of a branch; F, in k3/L^2, and y, in L: (vertices,).
Stability: 1 stable, 0 unstable, -1 unknown."""


def branch_answer_of_rod(rod: RodBranches, end: float) -> dict[str, Any]:
    """Variables of the answer "branch" for a rod, by name.

    pieces: parts of the branches of cycles, and of the straight rod from F = 0 to `end`, see `BranchPiece`.
    special: (F, y, kind, period), in the units k3/L^2, L and tau2, of each special point except ends of
    branches.
    """
    pieces: list[BranchPiece] = [
        (curve.parameter[run], curve.tip_y_max[run], stable)
        for curve in rod.curves
        for run, stable in runs_of_equal_stability(curve.stability)
    ]
    straight = rod.straight_rod_stability_intervals((0.0, end))
    pieces += [(np.array([low, high]), np.zeros(2), stable) for low, high, stable in straight]
    special_points = [
        (special_point.at, special_point.tip_y_max, special_point.kind, special_point.period)
        for curve in rod.curves
        for special_point in curve.special_points
    ]
    return {"pieces": pieces, "special": [point for point in special_points if point[2] != "end"]}
