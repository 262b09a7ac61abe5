"""Interface between a task and the commands `check` and `run`, which know no further details of a task."""

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

Arrays = dict[str, np.ndarray]
"""Result of a unit of work, arrays by name."""
InOrder = Callable[[Sequence[Any], Callable[[Any], Any]], list[Any]]
"""Maps a function over items, in their order, possibly sharing the work among ranks."""
Around = Callable[[int, State, Callable[[], tuple[Any, State]]], tuple[Any, State]]
"""Wraps the solve of a point: from index, starting state and solve to (outcome, neighbour's state)."""
Part = tuple[str, bool, str]
"""(part, whether it is modelled, reason): a row of the table printed by `check`."""


class Units(Protocol):
    """Work on all points, divided into units. The object is sent to all ranks; the wanted units may depend on
    results.
    """

    def wanted(self, results: Mapping[int, Arrays]) -> list[int]:
        """Units still wanted: the ones needed next come first; empty once all results are known."""

    def where(self, unit: int) -> str:
        """Name of a unit in words."""


class AllPoints(Protocol):
    """Variables that need all points, for example curves. The object exists on every rank."""

    def units(self, view: View) -> Any:
        """The work as `Units`, from the file with all points; None if nothing is done in units."""

    def starts(self, units: Any, wanted: Sequence[int]) -> dict[int, Any]:
        """Starting data for units, kept on this rank and useful to every rank."""

    def take(self, starts: Mapping[int, Any]) -> None:
        """Keeps starting data of a different rank."""

    def solve(self, units: Any, unit: int) -> Arrays:
        """Result of a unit."""

    def nothing(self) -> Arrays:
        """Result of a unit whose solver raised an unforeseen exception."""

    def variables(self, view: View, units: Any, results: Mapping[int, Arrays]) -> Sequence[Filled]:
        """Variables of the file from the results of all wanted units; called on the first rank."""


@dataclass(frozen=True, slots=True)
class Solver:
    """Functions by which every rank solves points; `solve` returns an outcome with status and message."""

    statuses: Sequence[PointStatus]
    warm_up: Callable[[], object]
    """Triggers compilation and fills caches before any point is timed."""
    solve: Callable[[int], Any]
    record: Callable[[int, Any], dict[str, Any]]
    """Converts an index and its outcome into variables of the file."""
    together: AllPoints | None = None
    """Variables that need all points; None for tasks without joint variables."""
    chained: ChainedWork | None = None
    """Replaces `solve` if points start from a neighbour's solution."""
    stretched: tuple[Stretches, SolveStretch] | None = None
    """Replaces `solve` if neighbours are solved together; takes flat indices."""

    def within(self, around: Around, together: SolveStretch | None = None, **changed: Any) -> "Solver":
        """The solver with `around` wrapped about every point's solve, and with `together` for stretches."""
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
    """Applies the work to all items on this rank."""
    return [work(item) for item in items]


@dataclass(frozen=True, slots=True)
class Task(ABC):
    """A task with points. The task is sent to all ranks and starts PETSc only when `solver` is called."""

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
        """Coordinates of extra dimensions of the layout, shape (extent,), by name."""
        return {}

    def constants(self, in_order: InOrder = on_this_rank) -> tuple[Filled, ...]:
        """Variables that depend on no point. in_order: shares slow work among ranks."""
        return ()

    def afterwards(self, values: Mapping[str, Any]) -> tuple[Filled, ...]:
        """Variables computed from all points at once, without units of work.

        values: variables of the points by name, shape (points, own dimensions), readable by slices.
        """
        return ()

    @abstractmethod
    def headline(self) -> str:
        """One line: the number of points and the request for each point."""

    def arms(self) -> str:
        """A line on arms not uniform or of rubber: variation, law, first mesh; empty for all other arms."""
        return ""

    @abstractmethod
    def parts(self) -> list[Part]:
        """Modelled and neglected parts."""

    @abstractmethod
    def cost(self) -> Estimate:
        """Estimated cost of the run."""

    @abstractmethod
    def solver(self) -> Solver:
        """The solver of the points; starts PETSc."""
