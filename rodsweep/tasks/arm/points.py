"""Points of an arm that no rod covers, which get a status, and those of one and the same rod, solved once."""

from collections import OrderedDict
from collections.abc import Callable, Hashable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...config.arm.axes import CRUSHED, NO_FLUTTER, NO_WALL, NOT_SLENDER, SLENDER
from ...model.arm.drag import LEAST_SLENDERNESS
from ...model.arm.neglected import Validity
from ...results.layouts.arm import VALIDITY
from ...results.layouts.variables import SECONDS, STATUS, Layout
from ...solve.status import PointStatus
from ...sweep.points.chains import State
from ...sweep.points.points import Points
from ...sweep.points.stretches import StretchResult
from ..protocol import Solver

MODEL_APPLIES = VALIDITY[0].name
REMEMBERED = 1e8
"""Bytes of outcomes that a rank remembers, about."""
SMALLEST_OUTCOME = 10_000
"""Bytes that an outcome takes beside its variables, at least."""


class NoRod(PointStatus):
    """Outcome of a point that no rod covers, of any task."""

    not_slender = (
        NOT_SLENDER,
        f"the arm is shorter than {LEAST_SLENDERNESS:g} radii, for which the drag of a slender arm is not "
        "known, so nothing is computed",
        True,
    )
    crushed = CRUSHED, "the load compresses the arm to nothing, F >= k1, so nothing is computed", True
    no_flutter = (
        NO_FLUTTER,
        "the load is relative to flutter, and with the likeliest drag the arm does not flutter, so nothing "
        "is computed",
        True,
    )
    no_wall = NO_WALL, "the bore is as wide as the arm, so nothing is computed", True


@dataclass(frozen=True, slots=True)
class Uncovered:
    """The outcome of such a point."""

    status: NoRod
    message: str = ""


@dataclass(frozen=True, slots=True)
class Again:
    """The outcome of a point whose rod was solved at another point."""

    outcome: Any

    @property
    def status(self) -> Any:
        """How the solve ended."""
        return self.outcome.status

    @property
    def message(self) -> str:
        """What the solve has to say."""
        return str(self.outcome.message)


def same_rods(points: Points) -> NDArray[np.int64] | None:
    """The number of the rod of each point of a grid over an arm's quantities, (points,); None if all differ.

    Viscosity and densities move no parameter, Young's modulus none without a load or with a relative one.
    """
    if not points.over:
        return None
    table = np.stack(points.columns, axis=-1)
    rods = np.unique(np.nan_to_num(table, nan=-1.0), axis=0, return_inverse=True)[1].ravel()
    return None if rods.max() + 1 == len(rods) else rods


def shared(solver: Solver, points: Points, layout: Layout) -> Solver:
    """The solver that remembers outcomes, so that a rod of several points is solved once on a rank.

    Points that start one from the other are the same if they start from the same state, that of an outcome
    which is remembered. Spectra along stretches take less than a millisecond a point: they are left as they
    are.
    """
    rods = None if solver.stretched else same_rods(points)
    if rods is None:
        return solver
    memory = _Outcomes(max(1, int(REMEMBERED // max(layout.bytes_per_point, SMALLEST_OUTCOME))))

    def once(index: int, start: State, solve: Callable[[], tuple[Any, State]]) -> tuple[Any, State]:
        (outcome, state), again = memory.of((int(rods[index]), start), solve)
        return Again(outcome) if again else outcome, state

    def record(index: int, outcome: Any) -> dict[str, Any]:
        if isinstance(outcome, Again):
            return solver.record(index, outcome.outcome) | {SECONDS.name: 0.0}
        return solver.record(index, outcome)

    return solver.within(once, record=record)


@dataclass(slots=True)
class _Outcomes:
    """The outcomes of the last solves of a rank."""

    most: int
    kept: OrderedDict[Hashable, Any] = field(default_factory=OrderedDict)

    def of(self, key: Hashable, solve: Callable[[], Any]) -> tuple[Any, bool]:
        """(what a solve gives, whether it was solved before)."""
        if key in self.kept:
            self.kept.move_to_end(key)
            return self.kept[key], True
        found = self.kept[key] = solve()
        if len(self.kept) > self.most:
            self.kept.popitem(last=False)
        return found, False


def around(solver: Solver, points: Points, layout: Layout) -> Solver:
    """The solver that leaves out points that no rod covers, whose variables have their fill."""
    if points.covered is None or not points.covered.any():
        return solver
    return _Around(solver, points.covered, layout).solver()


@dataclass(frozen=True, slots=True)
class _Around:
    """A solver of points, of which those without a rod have a status in `covered`, (points,)."""

    inner: Solver
    covered: NDArray[np.int8]
    layout: Layout

    def solver(self) -> Solver:
        """The solver around the inner one."""
        statuses = (*self.inner.statuses, *NoRod)
        return self.inner.within(self._solve, self._together, record=self._record, statuses=statuses)

    def _solve(self, index: int, start: State, solve: Callable[[], tuple[Any, State]]) -> tuple[Any, State]:
        if self.covered[index] == SLENDER:
            return solve()
        return Uncovered(next(status for status in NoRod if status == self.covered[index])), None

    def _record(self, index: int, outcome: Any) -> dict[str, Any]:
        if not isinstance(outcome, Uncovered):
            return self.inner.record(index, outcome)
        return self._empty | {STATUS.name: int(outcome.status)}

    @property
    def _empty(self) -> dict[str, Any]:
        """Every variable of a point without a rod but its status."""
        return self.layout.empty_point | {SECONDS.name: 0.0, MODEL_APPLIES: Validity.does_not_apply}

    def _together(self, indices: NDArray[np.int64]) -> StretchResult:
        """What comes of the points of a stretch, of which only those with a rod are solved."""
        assert self.inner.stretched is not None
        covered = self.covered[indices]
        places = np.flatnonzero(covered == SLENDER)
        values = {name: np.stack([value] * len(indices)) for name, value in self._empty.items()}
        values[STATUS.name][...] = covered
        found = self.inner.stretched[1](indices[places]) if len(places) else None
        for name, column in found.values.items() if found else ():
            values[name][places] = column
        succeeded = np.ones(len(indices), bool)
        if found:
            succeeded[places] = found.succeeded
        return StretchResult(
            values, succeeded, lambda i: found.message(int(np.searchsorted(places, i))) if found else ""
        )
