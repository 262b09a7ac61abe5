"""Solves all results of a portrait of one rod: thresholds, criticality, branches, modes, three cycles."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from ..config.document.reading import validated_config
from ..config.parameters_section import DEFAULT_F_MAX
from ..config.tasks import CONFIG_CLASSES_BY_TASK
from ..errors import InputError
from ..model.parameters import OPTIONAL_PARAMETER_NAMES
from ..post.branch_curves import RodBranches
from ..post.range_unions import ParameterRange
from ..post.rod_portrait.results import DescribedRod, RodResults
from ..results.file.view import ResultView
from ..results.layouts.thresholds import CROSSING_KINDS
from .running.in_memory import solve_job_in_memory
from .running.job import Job, job_of_config

CYCLE_POSITIONS_IN_STABLE_RANGES = (0.1, 0.5, 0.9)
"""Positions of the forces of the three cycles in the ranges of F with a stable cycle, counted from the
smallest force, as fractions of the total length of these ranges."""
SHAPE_COUNT = 12
"""Number of shapes per period of each cycle; a small panel has no room for more."""
LARGE_INITIAL_DEFLECTION = 0.5
"""Initial tip deflection in L, large enough to reach a stable cycle even if the straight rod is also
stable."""
LEADING_MODE_THRESHOLD_KINDS = ("onset", "hopf")
"""Kinds of thresholds; the leading mode is solved at the first threshold of each kind."""
DEFAULT_BRANCH_ACCURACY = 1e-5
"""Relative accuracy of the cycles on the branches of a portrait without a requested accuracy, far below a
line width of the picture. Special points are located to 1e-9 at every accuracy, as far as
MAX_PORTRAIT_BRANCH_WORK allows."""
MAX_PORTRAIT_BRANCH_WORK = 300.0
"""Limit `work` of the branches of a portrait: 15 to 30 s, and at most 1 GB for a matrix. A cone of taper 0.19
needs 300 up to F = 15, three times its Hopf point, and ever more at larger forces."""
SolveJobFunction = Callable[[Job], ResultView]
"""Function that solves the only point of a job."""


@dataclass(frozen=True, slots=True, kw_only=True)
class PortraitRequest:
    """Request for a portrait.

    rod: the rod. F_max: largest force. accuracy: relative accuracy of all tasks; if None, branches have the
    accuracy DEFAULT_BRANCH_ACCURACY and every other task has its default.
    """

    rod: DescribedRod
    F_max: float = DEFAULT_F_MAX
    accuracy: float | None = None

    @property
    def branch_options(self) -> dict[str, Any]:
        """Options of the task branch for the branches of the portrait."""
        return {"start": 0.0, "stop": self.F_max, "work": MAX_PORTRAIT_BRANCH_WORK}

    def job_of_task(
        self,
        task: str,
        options: Mapping[str, Any],
        F: float | None = None,
        default_accuracy: float | None = None,
    ) -> Job:
        """Job of a task for this rod. options: options of the task by name. F: force, None for tasks that
        vary the force. default_accuracy: relative accuracy if the request has none; None for the default of
        the task."""
        given_values = self.rod.parameters
        names = (*CONFIG_CLASSES_BY_TASK[task].rod_parameters_used(options), *OPTIONAL_PARAMETER_NAMES)
        values: dict[str, Any] = {
            name: given_values[name] for name in names if name in given_values and name != "F"
        }
        values |= {"arm": dict(self.rod.arm)} if self.rod.arm else {}
        values |= {} if F is None else {"F": F}
        document: dict[str, Any] = {"task": task, "parameters": values, task: dict(options)}
        document |= {"material": dict(self.rod.material)} if self.rod.material else {}
        accuracy = default_accuracy if self.accuracy is None else self.accuracy
        document |= {} if accuracy is None else {"accuracy": accuracy}
        return job_of_config(Path(task), validated_config(document), document)


def solve_rod_results(request: PortraitRequest, solve: SolveJobFunction = solve_job_in_memory) -> RodResults:
    """Solves and returns all results of a portrait.

    solve: function that solves the only point of a job. If a result cannot be solved,
    `RodResults.missing_result_reasons` has the reason. Raises InputError if the parameters are outside their
    ranges.
    """
    F_max = {"F_max": request.F_max}
    views = {"thresholds": solve(request.job_of_task("thresholds", F_max))}
    missing: dict[str, str] = {}

    def solved(
        task: str, options: Mapping[str, Any], F: float | None = None, default_accuracy: float | None = None
    ) -> ResultView | None:
        try:
            return solve(request.job_of_task(task, options, F, default_accuracy))
        except InputError as error:
            missing.setdefault(task, str(error))
            return None

    if (view := solved("criticality", F_max)) is not None:
        views["criticality"] = view
    view = solved("branch", request.branch_options, default_accuracy=DEFAULT_BRANCH_ACCURACY)
    if view is not None:
        views["branch"] = view
    modes = {
        kind: (F, view)
        for kind, F in first_threshold_forces(views["thresholds"]).items()
        if (view := solved("modes", {}, F)) is not None
    }
    ranges = RodBranches(views["branch"]).stable_cycle_ranges if "branch" in views else []
    forces = forces_of_three_stable_cycles(ranges)
    cycles = [(F, view) for F in forces if (view := _cycle_at_force(solved, F)) is not None]
    if not modes:
        missing.setdefault("modes", f"no threshold is known up to F = {request.F_max:g}")
    if not cycles:
        reason = missing.get("branch", "no stable cycle lies on a branch from a Hopf point")
        missing.setdefault("limit_cycle", reason)
    return RodResults(
        rod=request.rod,
        F_max=request.F_max,
        views=views,
        modes_at_first_thresholds=modes,
        cycles=cycles,
        missing_result_reasons=missing,
    )


def _cycle_at_force(
    solve: Callable[[str, Mapping[str, Any], float], ResultView | None], F: float
) -> ResultView | None:
    """The limit cycle at the force F, solved from the Hopf point or, if no cycle is found, from a large
    deflection. If both starts find no cycle, the result of the first start that gave a result; None if both
    gave None. solve: function (task, options, F) that solves a task, and returns None for invalid input."""
    result = None
    for start in ({"start": "hopf"}, {"start": "mode", "amplitude": LARGE_INITIAL_DEFLECTION}):
        view = solve("limit_cycle", {**start, "shapes": SHAPE_COUNT}, F)
        if view is not None and np.isfinite(view.variables["period"]).all():
            return view
        result = result or view
    return result


def first_threshold_forces(thresholds: ResultView) -> dict[str, float]:
    """Force of the first threshold of each kind in LEADING_MODE_THRESHOLD_KINDS, at which the leading mode is
    drawn."""
    kinds, forces = (thresholds.flattened_by_point(f"crossing_{name}")[0] for name in ("kind", "F"))
    first_forces = {}
    for kind in LEADING_MODE_THRESHOLD_KINDS:
        indices = np.flatnonzero(kinds == CROSSING_KINDS.index(kind))
        if len(indices):
            first_forces[kind] = float(forces[indices[0]])
    return first_forces


def forces_of_three_stable_cycles(ranges: Sequence[ParameterRange]) -> list[float]:
    """Forces of the three cycles, increasing: at CYCLE_POSITIONS_IN_STABLE_RANGES of the ranges of F with a
    stable cycle.

    A force is rounded to three digits if the rounded force is in the same range. Empty if `ranges` is empty.
    """
    if not ranges:
        return []
    lengths = np.array([high - low for low, high in ranges])
    cumulated = np.concatenate([[0.0], np.cumsum(lengths)])
    forces = []
    for fraction in CYCLE_POSITIONS_IN_STABLE_RANGES:
        position = fraction * cumulated[-1]
        number = min(int(np.searchsorted(cumulated, position, side="right")) - 1, len(ranges) - 1)
        low, high = ranges[number]
        force = float(low + position - cumulated[number])
        rounded = float(f"{force:.3g}")
        forces.append(rounded if low < rounded < high else force)
    return forces
