"""What a task is, for `check` and `run`: neither knows more of it than is said here."""

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...results.file.view import View
from ...results.layouts.variables import Filled
from ...solve.status import PointStatus
from ...sweep.chains import Chains, ChainStep
from ...sweep.estimate import Estimate
from ...sweep.grid import Points
from ...sweep.stretches import Stretches, Together

Part = tuple[str, bool, str]
"""(what, whether it is modelled, why): a row of what `check` prints."""


@dataclass(frozen=True, slots=True)
class Solver:
    """What every rank of a run does with a point; `solve` gives an outcome with status and message."""

    statuses: Sequence[PointStatus]
    warm_up: Callable[[], object]
    """Loads what is compiled and created at first use, so that no point pays for it."""
    solve: Callable[[int], Any]
    record: Callable[[int, Any], dict[str, Any]]
    """An index and its outcome as the variables of the file."""
    finish: Callable[[View], Sequence[Filled]] | None = None
    """Variables that only all points together give, on the first rank, from the file with all points."""
    chained: tuple[Chains, ChainStep] | None = None
    """Where points start one from the other: how they are solved, instead of by `solve`."""
    stretched: tuple[Stretches, Callable[[NDArray[np.int64]], Together]] | None = None
    """Where neighbours are solved together: how, from their flat indices, instead of by `solve`."""


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

    def constants(self) -> tuple[Filled, ...]:
        """Variables that are known without solving."""
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
