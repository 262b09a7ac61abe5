"""Points of an arm: points to which the rod model does not apply get a status, and each rank solves equal
rods only once."""

from collections.abc import Callable, Hashable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...config.arm.status import CRUSHED, FLUTTER_UNKNOWN, NO_FLUTTER, NO_WALL, NOT_SLENDER, SLENDER
from ...model.arm.drag import MIN_FORMULA_SLENDERNESS
from ...model.arm.neglected import Validity
from ...results.layouts.si_variables import VALIDITY_VARIABLES
from ...results.layouts.variables import SECONDS_VARIABLE, STATUS_VARIABLE, Layout
from ...solve.status import PointStatus
from ...sweep.points.chains import State
from ...sweep.points.groups import GroupResult
from ...sweep.points.points import Points
from ..protocol import Solver

MODEL_APPLIES_NAME = VALIDITY_VARIABLES[0].name
"""Name of the variable that states whether the model applies."""
MAX_OUTCOME_CACHE_BYTES = 1e8
"""Approximate memory, in bytes, of the outcomes that a rank caches for equal rods."""
MIN_OUTCOME_BYTES = 10_000
"""Minimum assumed memory of an outcome, in bytes: an outcome has more fields than the stored variables."""


class OutsideModelStatus(PointStatus):
    """Statuses, in every task, of the points of an arm to which the rod model does not apply."""

    not_slender = (
        NOT_SLENDER,
        f"the arm is shorter than {MIN_FORMULA_SLENDERNESS:g} radii, for which the drag of a slender arm is "
        "not known, so nothing is computed",
        True,
    )
    crushed = (
        CRUSHED,
        "the load F >= k1 compresses the arm to zero length (h1 = 0), so nothing is computed",
        True,
    )
    no_flutter = (
        NO_FLUTTER,
        "the load is relative to flutter, and with the likeliest drag the arm does not flutter, so nothing "
        "is computed",
        True,
    )
    flutter_unknown = (
        FLUTTER_UNKNOWN,
        "the load is relative to flutter, and the search could not determine the flutter threshold, so "
        "nothing is computed",
    )
    no_wall = NO_WALL, "the bore is as wide as the arm, which leaves no wall, so nothing is computed", True


@dataclass(frozen=True, slots=True)
class OutcomeOutsideModel:
    """Outcome of a point of an arm to which the rod model does not apply. status: reason. message: further
    text on the reason, or empty."""

    status: OutsideModelStatus
    message: str = ""


@dataclass(frozen=True, slots=True)
class RepeatedOutcome:
    """Outcome of a point whose rod was already solved at an earlier point. outcome: outcome of the earlier
    solve, with its status and message."""

    outcome: Any
    status: Any
    message: str


def numbers_of_distinct_rods(points: Points) -> NDArray[np.int64] | None:
    """Number of the rod at each point of a grid over an arm's quantities, (points,); equal rods have equal
    numbers. None if all rods differ, and for points that are not such a grid.

    Rods may be equal because viscosity and densities change no parameter, and Young's modulus changes no
    parameter if the arm has no load or a load relative to flutter.
    """
    if not points.arm_axes:
        return None
    columns = list(points.columns)
    if points.arm_materials:
        material_numbers = {material: float(i) for i, material in enumerate(points.arm_materials)}
        points_per_rod = points.count // len(points.arm_materials)
        columns.append(
            np.repeat([material_numbers[material] for material in points.arm_materials], points_per_rod)
        )
    table = np.stack(columns, axis=-1)
    rods = np.unique(np.nan_to_num(table, nan=-1.0), axis=0, return_inverse=True)[1].ravel()
    return None if rods.max() + 1 == len(rods) else rods


def solver_with_outcome_cache(solver: Solver, points: Points, layout: Layout) -> Solver:
    """A solver that caches outcomes, so that a rank solves a rod only once even if several points have this
    rod.

    In chains, an outcome is used again if the rods are equal and both points start from the same state.
    Points of groups, along which eigenvalues are followed, are always solved, because a point takes less than
    a millisecond.
    """
    rods = None if solver.groups_and_group_solver else numbers_of_distinct_rods(points)
    if rods is None:
        return solver
    max_outcomes = max(1, int(MAX_OUTCOME_CACHE_BYTES // max(layout.bytes_per_point, MIN_OUTCOME_BYTES)))
    cache: dict[Hashable, tuple[Any, State]] = {}  # the latest outcomes are last

    def once(index: int, start: State, solve: Callable[[], tuple[Any, State]]) -> tuple[Any, State]:
        key = int(rods[index]), start
        if key in cache:
            cache[key] = outcome, state = cache.pop(key)
            return RepeatedOutcome(outcome, outcome.status, outcome.message), state
        cache[key] = solved = solve()
        if len(cache) > max_outcomes:
            del cache[next(iter(cache))]
        return solved

    def record(index: int, outcome: Any) -> dict[str, Any]:
        if isinstance(outcome, RepeatedOutcome):
            return solver.file_values_of_outcome(index, outcome.outcome) | {SECONDS_VARIABLE.name: 0.0}
        return solver.file_values_of_outcome(index, outcome)

    return solver.with_wrapper(once, file_values_of_outcome=record)


@dataclass(frozen=True, slots=True)
class SolverSkippingPointsOutsideModel:
    """A solver that skips the points to which the rod model does not apply, and gives these points fill
    values.

    rod_solver: solver of the points to which the rod model applies. validity_codes: SLENDER for points to
    which the rod model applies, else a value of `OutsideModelStatus`, (points,). messages_by_point:
    additional messages by flat index of the point. layout: variables of a point.
    """

    rod_solver: Solver
    validity_codes: NDArray[np.int8]
    messages_by_point: Mapping[int, str]
    layout: Layout

    def solver_of_all_points(self) -> Solver:
        """The solver of all points. It solves the points to which the rod model applies, and gives fill
        values to the other points."""
        changed = {
            "file_values_of_outcome": self._file_values_of_outcome,
            "possible_statuses": (*self.rod_solver.possible_statuses, *OutsideModelStatus),
        }
        return self.rod_solver.with_wrapper(self._solve, self._solve_group, **changed)

    def _solve(self, index: int, start: State, solve: Callable[[], tuple[Any, State]]) -> tuple[Any, State]:
        if self.validity_codes[index] == SLENDER:
            return solve()
        status = next(status for status in OutsideModelStatus if status == self.validity_codes[index])
        return OutcomeOutsideModel(status, self.messages_by_point.get(index, "")), None

    def _file_values_of_outcome(self, index: int, outcome: Any) -> dict[str, Any]:
        if not isinstance(outcome, OutcomeOutsideModel):
            return self.rod_solver.file_values_of_outcome(index, outcome)
        return self._fill_values | {STATUS_VARIABLE.name: int(outcome.status)}

    @property
    def _fill_values(self) -> dict[str, Any]:
        """Every variable of a point to which the rod model does not apply, except its status."""
        return self.layout.fill_values_of_point | {
            SECONDS_VARIABLE.name: 0.0,
            MODEL_APPLIES_NAME: Validity.does_not_apply,
        }

    def _solve_group(self, indices: NDArray[np.int64]) -> GroupResult:
        """Results for the points of a group at flat indices, (n,); only points to which the rod model
        applies are solved."""
        assert self.rod_solver.groups_and_group_solver is not None
        validity_codes = self.validity_codes[indices]
        rod_indices = np.flatnonzero(validity_codes == SLENDER)
        values = {name: np.stack([value] * len(indices)) for name, value in self._fill_values.items()}
        values[STATUS_VARIABLE.name][...] = validity_codes
        result = (
            self.rod_solver.groups_and_group_solver[1](indices[rod_indices]) if len(rod_indices) else None
        )
        for name, column in result.variable_values.items() if result else ():
            values[name][rod_indices] = column
        is_solved = validity_codes != FLUTTER_UNKNOWN
        if result:
            is_solved[rod_indices] = result.is_solved
        return GroupResult(values, is_solved)
