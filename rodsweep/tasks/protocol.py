"""Interfaces of a task and its solver, through which `check` and `run` use all tasks alike."""

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Protocol

import numpy as np

from ..results.file.view import View
from ..results.layouts.variables import Filled
from ..solve.status import PointStatus
from ..sweep.cost_estimate import Estimate
from ..sweep.points.chains import ChainedWork, Chains, State
from ..sweep.points.points import Points
from ..sweep.points.stretches import SolveStretch, Stretches

NamedArrays = dict[str, np.ndarray]
"""Arrays by name: the result of a unit of joint work."""
OrderedMap = Callable[[Sequence[Any], Callable[[Any], Any]], list[Any]]
"""Function (items, function) -> results in the order of the items; the work may be shared among ranks."""
SolveWrapper = Callable[[int, State, Callable[[], tuple[Any, State]]], tuple[Any, State]]
"""Wrapper of the solve of a point: (index, starting state, solve) -> (outcome, state for the next point)."""
CheckRow = tuple[str, bool, str]
"""Row of the table printed by `check`: (effect or result, whether it is modelled, reason)."""


class Units(Protocol):
    """Units of work of joint variables, numbered from 0. The object is sent to all ranks."""

    def wanted(self, results: Mapping[int, NamedArrays]) -> list[int]:
        """Numbers of the units still to be solved, most urgent first; empty if no unit is left.

        results: results of the finished units, by number.
        """

    def where(self, unit: int) -> str:
        """Description of a unit in words, for the progress display and the log."""


class JointVariables(Protocol):
    """Computes variables that depend on all points, for example curves. Every rank has such an object."""

    def units(self, view: View) -> Any:
        """The units of work; None if no work is divided into units. view: the file with all points."""

    def starts(self, units: Any, wanted: Sequence[int]) -> dict[int, Any]:
        """Starting data that this rank has for the wanted units, to be sent to all ranks."""

    def take(self, starts: Mapping[int, Any]) -> None:
        """Keeps starting data received from a different rank."""

    def solve(self, units: Any, unit: int) -> NamedArrays:
        """Solves a unit of work; returns its result."""

    def empty_result(self) -> NamedArrays:
        """Empty result, for a unit of work whose solver raised an unforeseen exception."""

    def variables(self, view: View, units: Any, results: Mapping[int, NamedArrays]) -> Sequence[Filled]:
        """The joint variables for the result file; called on the first rank only.

        view: the file with all points. results: results of all units, by number.
        """


@dataclass(frozen=True, slots=True)
class Solver:
    """Functions with which every rank solves the points of a task."""

    statuses: Sequence[PointStatus]
    """All statuses that a point can have."""
    warm_up: Callable[[], object]
    """Triggers compilation and fills caches before any point is timed."""
    solve: Callable[[int], Any]
    """Solves the point with an index; returns an outcome with the attributes `status` and `message`."""
    record: Callable[[int, Any], dict[str, Any]]
    """Converts the index and the outcome of a point into values of the file's variables by name."""
    together: JointVariables | None = None
    """Computes the variables that depend on all points; None for tasks without such variables."""
    chained: ChainedWork | None = None
    """Chains of points that start from their neighbours' solutions; replaces `solve`. None without chains."""
    stretched: tuple[Stretches, SolveStretch] | None = None
    """(stretches of neighbouring points, function that solves the points of a stretch by their flat indices);
    replaces `solve`. None without stretches."""

    def within(self, around: SolveWrapper, together: SolveStretch | None = None, **changed: Any) -> "Solver":
        """A copy whose solve of every point is wrapped by `around`, with changed fields.

        together: function that solves a stretch instead of the present function, if the solver has stretches.
        """
        chained = self.chained
        stretched = self.stretched
        if chained is not None:
            step = chained.solve_from
            chained = replace(
                chained, solve_from=lambda index, state: around(index, state, lambda: step(index, state))
            )
        if stretched is not None and together is not None:
            stretched = stretched[0], together

        def solve(index: int) -> Any:
            return around(index, None, lambda: (self.solve(index), None))[0]

        return replace(self, solve=solve, chained=chained, stretched=stretched, **changed)


def on_this_rank(items: Sequence[Any], work: Callable[[Any], Any]) -> list[Any]:
    """Results of `work` for all items, computed on this rank alone."""
    return [work(item) for item in items]


@dataclass(frozen=True, slots=True)
class Task(ABC):
    """A task of a config on its points. The object is sent to all ranks; only `solver` starts PETSc."""

    config: Any
    """The config, of the task's own class."""
    points: Points

    @property
    def chains(self) -> Chains | None:
        """Chains of points, each started from the solution of the previous point; None without chains."""
        return None

    @property
    def stretches(self) -> Stretches | None:
        """Stretches of neighbours solved together; None without stretches."""
        return None

    def coordinates(self) -> dict[str, np.ndarray]:
        """Coordinates, (extent,), of the layout's dimensions beside the points, by dimension."""
        return {}

    def constants(self, in_order: OrderedMap = on_this_rank) -> tuple[Filled, ...]:
        """Variables of the file that depend on the config alone. in_order: shares slow work among ranks."""
        return ()

    def afterwards(self, values: Mapping[str, Any]) -> tuple[Filled, ...]:
        """Variables of the file computed from the results of all points, on the first rank alone.

        values: variables of the points by name, shape (points, own dimensions), readable by slices.
        """
        return ()

    @abstractmethod
    def headline(self) -> str:
        """Line of `check` with the number of points and the request for each point."""

    def arms(self) -> str:
        """Line of `check` on the shape, the law and the first mesh of arms that are not uniform or of rubber.

        Empty for all other arms.
        """
        return ""

    @abstractmethod
    def check_rows(self) -> list[CheckRow]:
        """Rows of the table, printed by `check`, of modelled and neglected effects."""

    @abstractmethod
    def cost(self) -> Estimate:
        """Estimated cost of the run."""

    @abstractmethod
    def solver(self) -> Solver:
        """The functions that solve the points. Starts PETSc."""
