"""Points of a grid over an arm's quantities that no rod covers: they get a status, and the sweep goes on."""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..config.arm import CRUSHED, NO_WALL, NOT_SLENDER, SLENDER
from ..model.drag import LEAST_SLENDERNESS
from ..model.neglected import Validity
from ..results.layouts.arm import VALIDITY
from ..results.layouts.variables import SECONDS, STATUS, Layout
from ..solve.status import PointStatus
from ..sweep.chains import State
from ..sweep.grid import Points
from ..sweep.stretches import Together
from .protocol import Solver

MODEL_APPLIES = VALIDITY[0].name


class NoRod(PointStatus):
    """Outcome of a point that no rod covers, of any task."""

    not_slender = (
        NOT_SLENDER,
        f"the arm is shorter than {LEAST_SLENDERNESS:g} radii, for which the drag of a slender arm is not "
        "known, so nothing is computed",
        True,
    )
    crushed = CRUSHED, "the load compresses the arm to nothing, F >= k1, so nothing is computed", True
    no_wall = NO_WALL, "the bore is as wide as the arm, so nothing is computed", True


@dataclass(frozen=True, slots=True)
class Uncovered:
    """The outcome of such a point."""

    status: NoRod
    message: str = ""


def around(solver: Solver, points: Points, layout: Layout) -> Solver:
    """The solver that leaves out points that no rod covers, whose variables have their fill."""
    if points.covered is None or not points.covered.any():
        return solver
    return _Around(solver, points, layout).solver()


@dataclass(frozen=True, slots=True)
class _Around:
    inner: Solver
    points: Points
    layout: Layout

    def solver(self) -> Solver:
        """The solver around the inner one."""
        inner = self.inner
        return replace(
            inner,
            statuses=(*inner.statuses, *NoRod),
            solve=self._solve,
            record=self._record,
            chained=(inner.chained[0], self._solve_from) if inner.chained else None,
            stretched=(inner.stretched[0], self._together) if inner.stretched else None,
        )

    def _uncovered(self, index: int) -> Uncovered:
        assert self.points.covered is not None
        return Uncovered(next(status for status in NoRod if status == self.points.covered[index]))

    def _solve(self, index: int) -> Any:
        return self.inner.solve(index) if self.points.has_rod(index) else self._uncovered(index)

    def _solve_from(self, index: int, state: State) -> tuple[Any, State]:
        assert self.inner.chained is not None
        if not self.points.has_rod(index):
            return self._uncovered(index), None
        return self.inner.chained[1](index, state)

    def _record(self, index: int, outcome: Any) -> dict[str, Any]:
        if not isinstance(outcome, Uncovered):
            return self.inner.record(index, outcome)
        return self._filled() | {STATUS.name: int(outcome.status), MODEL_APPLIES: Validity.does_not_apply}

    def _filled(self) -> dict[str, Any]:
        """Every variable of a point without numbers."""
        variables = self.layout.variables
        values = {v.name: np.full(self.layout.inner(v), v.fill, v.dtype) for v in variables}
        return values | {SECONDS.name: 0.0}

    def _together(self, indices: NDArray[np.int64]) -> Together:
        """What comes of the points of a stretch, of which only those with a rod are solved."""
        assert self.inner.stretched is not None and self.points.covered is not None
        covered = self.points.covered[indices]
        places = np.flatnonzero(covered == SLENDER)
        values = {name: np.stack([value] * len(indices)) for name, value in self._filled().items()}
        values[STATUS.name][...] = covered
        values[MODEL_APPLIES][...] = Validity.does_not_apply
        found = self.inner.stretched[1](indices[places]) if len(places) else None
        for name, column in found.values.items() if found else ():
            values[name][places] = column
        succeeded = np.ones(len(indices), bool)
        if found:
            succeeded[places] = found.succeeded
        return Together(
            values, succeeded, lambda i: found.told(int(np.searchsorted(places, i))) if found else ""
        )
