"""Questions of the page and the answers of a solver process, as plain arrays without objects of solvers.

The page shows progress, so that no solve displays it on the terminal, which all solver processes share.
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
from ...config.axes import DEFAULTS
from ...errors import InputError
from ...post.branch_curves import RodBranches
from ..state import LAWS, PageState, rod_of
from .branches import drawn_branches
from .diagrams import Dataset, cycle_diagram, diagram, words_of
from .letting_go import Tip, bent, film_of_motion, motion

Found = dict[str, Any]
"""Variables of an answer by name, as arrays; `status`, `sentence` and `message` are text."""
MODES = 6
"""Number of eigenvalues in the picture of the spectrum."""
SHAPES = 48
"""Number of shapes of the arm over a period; the browser interpolates between shapes."""
GROWTH_FORCES = 121
"""Number of forces of the curve of growth rates."""
BELOW_CRUSHING = 0.98
"""Largest force of a curve, as a fraction of the force that crushes the thinnest section."""


@dataclass(frozen=True)
class Question:
    """A question of a page.

    kind: a key of `ANSWERS`, or of `ANSWERS_TO_TIP`, which need the place of the tip, in L.
    state: state of the page when asked. stored: a cycle of a result file, of which a film needs no solve.
    """

    kind: str
    state: PageState
    tip: Tip | None = None
    stored: Dataset | None = None


class Reply(NamedTuple):
    """Reply of a solver process.

    outcome: "answer", "refused", "failed" or "cancelled"; "ready" is sent once, when the process has started,
    and "progress" during a long solve, with `words` and `share` of a `SolvePosition` as content.
    content: variables of an answer by name; for other outcomes a sentence by the name `sentence`. seconds:
    time of the solve.
    """

    outcome: str
    content: Found
    seconds: float


def variables(answer: Answer) -> Found:
    """All variables of an answer by name, with status, sentence, message and units."""
    found: Found = {str(name): array.values for name, array in answer.data.variables.items()}
    return found | {
        "status": str(answer.status), "sentence": answer.sentence, "message": answer.message,
        "units": answer.units,
    }  # fmt: skip


def spectrum(state: PageState) -> Found:
    """Leading eigenvalues with their count, and the shapes of the modes."""
    return variables(state.subject().spectrum(modes=MODES, vectors=True, progress=False))


def thresholds(state: PageState) -> Found:
    """Forces at which stability changes; `kinds` are the words of `crossing_kind`."""
    answer = state.subject().thresholds(F_max=state.largest_force(), progress=False)
    return variables(answer) | {"kinds": words_of(answer.data["crossing_kind"]).tolist()}


def growth(state: PageState) -> Found:
    """Growth rates of the leading modes along F, in `unit`: 1/tau2 of a rod, 1/s of an arm."""
    subject = state.subject()
    tau2 = subject.tau2 if isinstance(subject, Arm) else 1.0
    rod = rod_of(subject)
    keywords: dict[str, Any] = {n: rod[n] for n in ("k1", "k2", "gamma3", "taper") if n in rod}
    keywords |= {"material": LAWS[state.law]} if LAWS[state.law] else {}
    F = np.linspace(0, min(state.largest_force(), BELOW_CRUSHING * crushing_force(rod)), GROWTH_FORCES)
    data = sweep("spectrum", F=F, **keywords, certify=False, progress=False)
    rates = data["growth_rate"].values.reshape(GROWTH_FORCES, -1) / tau2
    unit = "1/s" if isinstance(subject, Arm) else "1/tau2"
    count = data["unstable_count"].values.reshape(-1)
    return {"F": F, "growth_rate": rates, "unit": unit, "unstable_count": count}


def cycle(state: PageState) -> Found:
    """The limit cycle, with the shapes of the arm over a period; x, y: the straight arm."""
    return variables(state.subject().cycle(shapes=SHAPES, progress=False)) | bent(state, None)


def film(state: PageState) -> Found:
    """Film that `rodsweep plot` makes of the limit cycle, as bytes by the name `gif`; InputError for a rod
    without a cycle.
    """
    answer = state.subject().cycle(shapes=SHAPES, progress=False)
    if not np.isfinite(answer.data["shape_x"].values).all():
        raise InputError(f"there is no cycle to film: {answer.sentence}")
    return film_of(answer)


def film_of(cycle: Answer | Dataset) -> Found:
    """Film of a cycle whose shapes are solved, as bytes by the name `gif`."""
    return {"gif": plot(cycle, what="animation").image}


def branch(state: PageState) -> Found:
    """Branches of cycles along F.

    pieces: (F, y, stable) of each piece of a branch or of the straight state; stable is 1 or 0, -1 if not
    known. special: (F, y, kind, period) of each special point.
    """
    answer = state.subject().branch(stop=state.largest_force(), progress=False)
    rod = RodBranches(view_of_dataset(answer.whole, Path(answer.rod)))
    found = drawn_branches(rod, state.largest_force())
    return found | {"status": str(answer.status), "sentence": answer.sentence}


def crushing_force(rod: Mapping[str, float]) -> float:
    """Force that crushes the thinnest section of a rod of linear material: k1, less for a thin tip."""
    return rod["k1"] * min(1.0, rod.get("taper", DEFAULTS.get("taper", 1.0))) ** 2


ANSWERS: dict[str, Callable[[PageState], Found]] = {
    "spectrum": spectrum,
    "thresholds": thresholds,
    "growth": growth,
    "cycle": cycle,
    "branch": branch,
    "diagram": diagram,
    "cycles": cycle_diagram,
    "film": film,
}
ANSWERS_TO_TIP: dict[str, Callable[[PageState, Tip], Found]] = {
    "bent": bent,
    "motion": motion,
    "film": film_of_motion,
}


def answer_to(question: Question) -> Found:
    """The answer to a question; InputError for invalid values."""
    if question.stored is not None:
        return film_of(question.stored)
    if question.tip is not None:
        return ANSWERS_TO_TIP[question.kind](question.state, question.tip)
    return ANSWERS[question.kind](question.state)
