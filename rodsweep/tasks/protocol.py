"""Interfaces of a task and its solver, by which `check` and `run` handle all tasks in the same way."""

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, ClassVar, Protocol

import numpy as np

from ..results.file.view import ResultView
from ..results.layouts.variables import FilledVariable
from ..solve.status import PointStatus
from ..sweep.chunk_queue import ItemChooser
from ..sweep.cost_estimate import CostEstimate
from ..sweep.points.chains import Chains, State, SweepChains
from ..sweep.points.groups import GroupSolveFunction, PointGroups
from ..sweep.points.points import Points

NamedArrays = dict[str, np.ndarray]
"""Arrays by name: the result of a work item for variables that depend on all points."""
MapInOrder = Callable[[Sequence[Any], Callable[[Any], Any]], list[Any]]
"""Function (items, function) -> results in the order of the items; the work may be shared among ranks."""
SolveWrapper = Callable[[int, State, Callable[[], tuple[Any, State]]], tuple[Any, State]]
"""Wrapper of the solve of a point: (flat index, initial state, solve) -> (outcome, initial state of the next
point)."""
CheckRow = tuple[str, bool, str]
"""Row of the table printed by `check`: (effect or result, whether it is modelled, reason)."""


class WorkItems(ItemChooser, Protocol):
    """Work items, numbered from 0, for variables that depend on all points: an `ItemChooser` that also
    describes its items. The object is sent to all ranks."""

    done_item_phrase: ClassVar[str]
    """Phrase for one item and the work done on it, as in "piece of curves followed"."""
    progress_noun: ClassVar[str]
    """Plural noun for items in the progress display."""

    def item_label(self, item: int) -> str:
        """Text describing an item, for the progress display and the log."""


@dataclass(frozen=True, slots=True)
class SweepWideResult:
    """Variables that depend on all points, for the result file. changed_points: for each point that has
    changed since it was solved, by flat index, the new values of its variables, by name. messages: message
    for the user on each of these points, by flat index."""

    sweep_wide_variables: Sequence[FilledVariable]
    changed_points: Mapping[int, NamedArrays] = field(default_factory=dict)
    messages: Mapping[int, str] = field(default_factory=dict)


class SweepWideVariableSolver(Protocol):
    """Computes variables that depend on all points, for example curves. Every rank has its own object."""

    def work_items(self, view: ResultView, results: Mapping[int, NamedArrays]) -> WorkItems | None:
        """The work items of the stage that is to be solved now, to be divided among the ranks; after the last
        stage, the items of the last stage again, which are then all solved. The items of different stages
        have different numbers. None if the variables need no work items.

        view: the file with all points. results: results of work items so far, by number.
        """

    def cached_branch_starts(self, items: Any, item_numbers: Sequence[int]) -> dict[Any, Any]:
        """Initial data, by key, that this rank has cached for the work items numbered `item_numbers` of
        `items`, to be sent to all ranks."""

    def cache_starts(self, starts: Mapping[Any, Any]) -> None:
        """Caches initial data received from a different rank. starts: initial data by key, as from
        `cached_branch_starts`."""

    def solve_item(self, items: Any, item: int) -> NamedArrays:
        """Solves the work item number `item` of `items`, and returns its result."""

    def empty_result(self, items: Any) -> NamedArrays:
        """Empty result, for a work item of `items` whose solver raised an unforeseen exception."""

    def result(self, view: ResultView, results: Mapping[int, NamedArrays]) -> SweepWideResult:
        """The variables that depend on all points, and the points that change; called on the first rank only.

        view: the file with all points. results: results of all work items, by number.
        """


@dataclass(frozen=True, slots=True)
class Solver:
    """Functions with which every rank solves the points of a task."""

    possible_statuses: Sequence[PointStatus]
    """All statuses that a point can have."""
    warm_up: Callable[[], object]
    """Triggers compilation and fills caches before any point is timed."""
    solve: Callable[[int], Any]
    """Solves the point at a flat index; returns an outcome with the attributes `status` and `message`."""
    file_values_of_outcome: Callable[[int, Any], dict[str, Any]]
    """Function from (flat index, outcome) of a point to the values of the file's variables, by name."""
    sweep_wide_solver: SweepWideVariableSolver | None = None
    """Computes the variables that depend on all points; None for tasks without such variables."""
    sweep_chains: SweepChains | None = None
    """Chains of points, each started from the solution of the previous point; used instead of `solve`. None
    if there are no chains."""
    groups_and_group_solver: tuple[PointGroups, GroupSolveFunction] | None = None
    """(groups of the sweep, function from the flat indices of the points of a group to their `GroupResult`),
    used instead of `solve`; None if no points are solved together."""

    def with_wrapper(
        self, solve_wrapper: SolveWrapper, solve_group: GroupSolveFunction | None = None, **changed: Any
    ) -> "Solver":
        """A copy of the solver in which `solve_wrapper` is called for every point, alone or in a chain, and
        calls the original solve.

        solve_group: new function that solves a group, if the solver has groups. changed: new values of other
        fields, by name.
        """
        chained = self.sweep_chains
        grouped = self.groups_and_group_solver

        def solve(index: int) -> Any:
            return solve_wrapper(index, None, lambda: (self.solve(index), None))[0]

        if chained is not None:
            step = chained.solve_from

            def solve_from(index: int, state: State) -> tuple[Any, State]:
                return solve_wrapper(index, state, lambda: step(index, state))

            chained = replace(chained, solve_from=solve_from)
        if grouped is not None and solve_group is not None:
            grouped = grouped[0], solve_group
        return replace(self, solve=solve, sweep_chains=chained, groups_and_group_solver=grouped, **changed)


def map_on_one_rank(items: Sequence[Any], work: Callable[[Any], Any]) -> list[Any]:
    """Results of `work` for all items, in order, computed on this rank only."""
    return [work(item) for item in items]


@dataclass(frozen=True, slots=True)
class Task(ABC):
    """A task of a config on its points. The object is sent to all ranks; only `solver` starts PETSc."""

    config: Any
    """The config, of the task's own class."""
    points: Points

    @property
    def chains(self) -> Chains | None:
        """Chains of points, each started from the solution of the previous point; None if there are no
        chains."""
        return None

    @property
    def groups(self) -> PointGroups | None:
        """Groups of points that are solved together; None if there are none."""
        return None

    def coordinates(self) -> dict[str, np.ndarray]:
        """Coordinate values, (length of the dimension,), of each dimension of the file that is not a
        dimension of the points, by name of the dimension. By default empty."""
        return {}

    def variables_from_config(self, in_order: MapInOrder = map_on_one_rank) -> tuple[FilledVariable, ...]:
        """Variables of the file that depend only on the config. in_order: maps a function over items, shared
        among the ranks. By default empty."""
        return ()

    def variables_from_points(self, values: Mapping[str, Any]) -> tuple[FilledVariable, ...]:
        """Variables of the file computed from the results of all points; called on the first rank only.

        values: variables of the points by name, shape (points, own dimensions), readable by slices. By
        default empty.
        """
        return ()

    @abstractmethod
    def headline_of_check(self) -> str:
        """Line of `check` with the number of points and the computation at each point."""

    def arms_line(self) -> str:
        """Line of `check` on the shape, the law and the initial mesh of arms that are not uniform or not of
        linear material.

        Empty for all other arms.
        """
        return ""

    @abstractmethod
    def rows_of_check(self) -> list[CheckRow]:
        """Rows of the table, printed by `check`, of modelled and neglected effects."""

    @abstractmethod
    def cost(self) -> CostEstimate:
        """Estimated cost of the run."""

    @abstractmethod
    def solver(self) -> Solver:
        """The functions that solve the points. Starts PETSc."""
