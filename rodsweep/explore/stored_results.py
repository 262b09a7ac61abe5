"""Answers from a result file, so that nothing is solved again: diagram, cycles and branches."""

import json
from collections.abc import Collection
from math import nan
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..api.dataset import view_of_dataset
from ..arrays import Array
from ..model.parameters import PARAMETERS
from ..post.branch_curves import RodBranches
from ..post.figures.cycle.animation import MIN_SHAPES
from ..results.file.view import sentences_in
from .scales import SCALES
from .solving.branches import drawn_branches
from .solving.diagrams import Dataset, words_of
from .state import PageState

Found = dict[str, Any]
DIGITS = (5, 6)
"""Significant digits to which controls round values of a file; a rounded value stands for the stored one."""
EQUAL = 1e-12
"""Relative difference between equal values, as conversion of units leaves it."""
POINT = "number_of_point"
"""Dimension along which chosen points lie."""
NEAR = 0.25
"""Distance within which a click means a stored load, as a fraction of the distance between stored loads."""


class StoredResults:
    """A result file of rods or of arms.

    state: state of the page opened by the file. diagram: answer to the question `diagram` in this state, or
    None.
    """

    def __init__(self, path: Path, data: Dataset, state: PageState, diagram: Found | None):
        self.path = path
        self.data = data
        self.state = state
        self.diagram = diagram
        self.dims = data["status"].dims
        """Dimensions of the points; none of a single point."""
        self.has_cycles = "tip_y_max" in data and data["tip_y_max"].dims == self.dims
        """Whether each point has one cycle."""

    def answer(self, kind: str, state: PageState) -> Found | None:
        """The stored answer to a question about a state; None if the file does not hold it."""
        if state.tab != self.state.tab or state.law != self.state.law:
            return None
        if kind == "cycle":
            return self._cycle(state) if self.has_cycles else None
        if kind == "branch":
            return self._cycles_over_force(state) if self.has_cycles else self._branch(state)
        return None

    def cycle_to_film(self, state: PageState) -> Dataset | None:
        """The stored cycle of a rod, with axes of length 1, if it has enough shapes for a film; else None."""
        numbers = self._points(state)
        is_other = state.tab != self.state.tab or state.law != self.state.law
        if is_other or not self.has_cycles or len(numbers) == 0 or "shape_x" not in self.data:
            return None
        places = np.unravel_index(numbers[0], self.data["status"].shape) if self.dims else ()
        point = self.data.isel({name: [int(i)] for name, i in zip(self.dims, places, strict=True)})
        is_filmed = words_of(point["status"]).item() == "cycle" and point.sizes["shape"] >= MIN_SHAPES
        return point if is_filmed else None

    def load_near(self, state: PageState, at: float) -> float:
        """The stored load, in the unit of its control, that a click at a load means, or the load itself."""
        if state.tab != self.state.tab or not self.has_cycles:
            return at
        stored = np.unique(self._values(state.tab, state.load)[self._points(state, (state.load,))])
        if len(stored) < 2:
            return at
        nearest = float(stored[np.argmin(np.abs(stored - at))])
        spacing = float(np.min(np.diff(stored)))
        return nearest if abs(nearest - at) < NEAR * spacing else at

    def _values(self, tab: str, name: str) -> Array:
        """Values of a parameter or of an arm's quantity at all points, (points,), in the control's unit."""
        default = PARAMETERS[name].default if name in PARAMETERS else None
        missing = nan if default is None else default
        own = self.data[name] if name in self.data.variables else missing
        everywhere = (self.data["status"] * 0.0 + own).transpose(*self.dims)
        values: Array = everywhere.values.ravel() * SCALES[tab][name].factor
        return values

    def _points(self, state: PageState, free: Collection[str] = ()) -> NDArray[np.integer]:
        """Numbers of the points of a state with any value of the free parameters."""
        same = np.ones(self.data["status"].size, dtype=bool)
        for name, text in state.values.items():
            if name not in free:
                value = SCALES[state.tab][name].value(text)
                own = self._values(state.tab, name)
                same &= np.array([value is not None and _stands_for(value, each) for each in own], dtype=bool)
        return np.flatnonzero(same)

    def _at(self, numbers: NDArray[np.integer]) -> Dataset:
        """Points by number, along the dimension `POINT`."""
        if not self.dims:
            return self.data.expand_dims(POINT)
        return self.data.stack({POINT: self.dims}, create_index=False).isel({POINT: numbers})

    def _cycle(self, state: PageState) -> Found | None:
        """The stored cycle of a rod, if its shapes are stored too."""
        numbers = self._points(state)
        if len(numbers) == 0 or "shape_x" not in self.data:
            return None
        point = self._at(numbers[:1]).isel({POINT: 0})
        status = str(words_of(point["status"]))
        F = float(point["F"])
        k1 = float(point["k1"])
        is_drawn = np.isfinite(point["shape_x"].values).all()
        if status == "missing" or (not is_drawn and not (state.law == "linear" and "taper" not in point)):
            return None
        found: Found = {str(name): array.values for name, array in point.variables.items()}
        u = point["u"].values
        return found | {
            "status": status, "sentence": sentences_in(self.data.attrs).get(status, ""),
            "message": f"stored in {self.path.name}",
            "units": {str(name): array.attrs["units"] for name, array in point.data_vars.items()},
            "x": (1 - F / k1) * u, "y": np.zeros(len(u)),
        }  # fmt: skip

    def _cycles_over_force(self, state: PageState) -> Found | None:
        """The stored cycles of a rod at all forces, at least two."""
        numbers = self._points(state, (state.load,))
        if len(numbers) < 2:
            return None
        line = self._at(numbers)
        y = line["tip_y_max"].values
        words = words_of(line["status"])
        y = np.where(words == "straight", 0.0, y)
        known = np.isfinite(y)
        stable = np.where(words[known] == "unstable", 0, 1)
        cycles = {"F": line["F"].values[known], "y": y[known], "stable": stable}
        return {"pieces": [], "special": [], "cycles": cycles, **self._found()}

    def _branch(self, state: PageState) -> Found | None:
        """The stored branches of a rod along the force."""
        numbers = self._points(state, (state.load,))
        if len(numbers) == 0 or "branch_F" not in self.data:
            return None
        rod = int(numbers[0])
        point = self._at(numbers[:1]).isel({POINT: 0})
        if words_of(point["status"]) == "missing":
            return None
        stop = float(json.loads(self.data.attrs["config_resolved"])["branch"]["stop"])
        return drawn_branches(RodBranches(view_of_dataset(self.data, self.path), rod), stop) | self._found()

    def _found(self) -> Found:
        return {"status": "ok", "sentence": "", "source": f"stored in {self.path.name}"}


def _stands_for(value: float, stored: float) -> bool:
    """Whether a control's value is a stored one, or the stored one rounded."""
    rounded = [float(f"{stored:.{digits}g}") for digits in DIGITS]
    return any(each == value or abs(each - value) <= EQUAL * abs(each) for each in (stored, *rounded))
