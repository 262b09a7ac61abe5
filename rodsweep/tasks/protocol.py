"""What a task is, for `check` and `run`: neither knows more of it than is said here."""

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
"""The result of a unit of work."""
InOrder = Callable[[Sequence[Any], Callable[[Any], Any]], list[Any]]
"""From items and a function to its values in their order: how work is shared among ranks."""
Around = Callable[[int, State, Callable[[], tuple[Any, State]]], tuple[Any, State]]
"""From an index, what its solve starts from and the solve to (outcome, state for the neighbour): what is done
around the solve of a point."""
Part = tuple[str, bool, str]
"""(what, whether it is modelled, why): a row of what `check` prints."""


class Units(Protocol):
    """Work on all points in units; which are wanted may depend on results. Sent to all ranks."""

    def wanted(self, results: Mapping[int, Arrays]) -> list[int]:
        """Units whose results are needed next, then some that may be; none once all are there."""

    def where(self, unit: int) -> str:
        """What a unit is, in words."""


class AllPoints(Protocol):
    """What only all points together give. On every rank."""

    def units(self, view: View) -> Any:
        """Its work in `Units`, from the file with all points; None where there is none in units."""

    def starts(self, units: Any, wanted: Sequence[int]) -> dict[int, Any]:
        """What this rank has that spares others the beginning of units."""

    def take(self, starts: Mapping[int, Any]) -> None:
        """Takes what another rank has."""

    def solve(self, units: Any, unit: int) -> Arrays:
        """The result of a unit."""

    def nothing(self) -> Arrays:
        """The result of a unit whose solver raised what nobody foresaw."""

    def variables(self, view: View, units: Any, results: Mapping[int, Arrays]) -> Sequence[Filled]:
        """Variables of the file, with the results of all units that were wanted. On the first rank."""


@dataclass(frozen=True, slots=True)
class Solver:
    """What every rank of a run does with a point; `solve` gives an outcome with status and message."""

    statuses: Sequence[PointStatus]
    warm_up: Callable[[], object]
    """Loads what is compiled and created at first use, so that no point pays for it."""
    solve: Callable[[int], Any]
    record: Callable[[int, Any], dict[str, Any]]
    """An index and its outcome as the variables of the file."""
    together: AllPoints | None = None
    """What only all points together give, where there is such."""
    chained: ChainedWork | None = None
    """Where points start one from the other: how they are solved, instead of by `solve`."""
    stretched: tuple[Stretches, SolveStretch] | None = None
    """Where neighbours are solved together: how, from their flat indices, instead of by `solve`."""

    def within(self, around: Around, together: SolveStretch | None = None, **changed: Any) -> "Solver":
        """The solver with something `around` the solve of every point, and `together` for stretches."""
        chained, stretched = self.chained, self.stretched
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


def alone(items: Sequence[Any], work: Callable[[Any], Any]) -> list[Any]:
    """The work on all items, on this rank."""
    return [work(item) for item in items]


@dataclass(frozen=True, slots=True)
class Task(ABC):
    """One task on its points: sent to all ranks, and without PETSc until its solver is asked for."""

    config: Any
    """Of the task's own kind."""
    points: Points

    @property
    def chains(self) -> Chains | None:
        """The chains in which points start one from the other, where they do."""
        return None

    @property
    def stretches(self) -> Stretches | None:
        """The stretches of neighbours that are solved together, where they are."""
        return None

    def coordinates(self) -> dict[str, np.ndarray]:
        """Values of the layout's extra dimensions that have some, shape (extent,)."""
        return {}

    def constants(self, in_order: InOrder = alone) -> tuple[Filled, ...]:
        """Variables that are known before any point is solved. in_order: shares what takes time."""
        return ()

    def afterwards(self, values: Mapping[str, Any]) -> tuple[Filled, ...]:
        """Variables that all points together give at once, without units of work.

        values: the variables of the points by name, of their shape and their own, to be read by slices.
        """
        return ()

    @abstractmethod
    def headline(self) -> str:
        """How many points there are, and what is asked of each."""

    @abstractmethod
    def parts(self) -> list[Part]:
        """What is modelled and what is left out."""

    @abstractmethod
    def cost(self) -> Estimate:
        """What the run will cost."""

    @abstractmethod
    def solver(self) -> Solver:
        """Starts PETSc, which only a valid config is worth."""
