"""Answers to requests of the page from a result file, without solving: diagram, cycles and branches."""

import json
from collections.abc import Collection
from math import nan
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ..api.dataset import view_of_dataset
from ..arrays import Array
from ..model.parameters import PARAMETERS
from ..post.branch_curves import RodBranches
from ..post.figures.cycle.animation import MIN_SHAPES_PER_PERIOD
from ..results.file.view import status_sentences_in
from .page_state import PageState
from .slider_scales import SLIDER_SCALES
from .solving.diagram_curves_and_unstable_counts import DatasetOrArray, flag_words
from .solving.requests import AnswerVariables, branch_answer_of_rod

CONTROL_DIGITS = (5, 6)
"""Numbers of significant digits to which controls round values. A control matches a stored value if the
control shows the stored value rounded to one of these numbers of digits."""
EQUALITY_TOLERANCE = 1e-12
"""Values that differ by at most this relative difference are equal; conversion of units causes rounding
errors."""
POINT_DIMENSION = "number_of_point"
"""Name of the dimension of the selected points in the result of `_data_at`."""
CLICK_TOLERANCE_IN_SPACINGS = 0.25
"""A click selects the nearest stored load if the distance between click and load, divided by the smallest
spacing of stored loads, is below this number."""


class AnswersFromFile:
    """Answers to requests of the page from a result file of rods or arms.

    data: content of the file `path`. state: state with which the page opens. diagram: answer to the request
    "diagram" for this state, or None.
    """

    def __init__(self, path: Path, data: DatasetOrArray, state: PageState, diagram: AnswerVariables | None):
        self.path = path
        self.data = data
        self.state = state
        self.diagram = diagram
        self.dims = data["status"].dims
        """Names of the dimensions of the sweep; empty for a single point."""
        self.has_cycles = "tip_y_max" in data and data["tip_y_max"].dims == self.dims
        """Whether the file has one limit cycle per point."""

    def answer(self, kind: str, state: PageState) -> AnswerVariables | None:
        """Stored answer to a request of the kind `kind` for the state `state` of the page; None if the file
        has no such answer."""
        if state.tab != self.state.tab or state.law != self.state.law:
            return None
        if kind == "cycle":
            return self._cycle(state) if self.has_cycles else None
        if kind == "branch":
            return self._cycles_over_force(state) if self.has_cycles else self._branch(state)
        return None

    def cycle_for_film(self, state: PageState) -> DatasetOrArray | None:
        """The stored cycle of the rod of `state`, as data in which every dimension of the sweep has the
        length 1. None if no stable cycle of this rod is stored, or if the cycle has too few shapes for a
        film."""
        numbers = self._matching_points(state)
        is_other = state.tab != self.state.tab or state.law != self.state.law
        if is_other or not self.has_cycles or len(numbers) == 0 or "shape_x" not in self.data:
            return None
        position = np.unravel_index(numbers[0], self.data["status"].shape) if self.dims else ()
        point = self.data.isel({name: [int(i)] for name, i in zip(self.dims, position, strict=True)})
        is_filmed = (
            flag_words(point["status"]).item() == "cycle" and point.sizes["shape"] >= MIN_SHAPES_PER_PERIOD
        )
        return point if is_filmed else None

    def load_selected_by_click(self, state: PageState, load: float) -> float:
        """Load that a click at `load` selects, in the unit of the control: the nearest stored load if its
        distance is small, see `CLICK_TOLERANCE_IN_SPACINGS`; otherwise `load`. Also `load` if the file has no
        cycles, fewer than two loads for the rod of `state`, or results of the other tab."""
        if state.tab != self.state.tab or not self.has_cycles:
            return load
        stored_loads = np.unique(
            self._control_values(state.tab, state.load_name)[self._matching_points(state, (state.load_name,))]
        )
        if len(stored_loads) < 2:
            return load
        nearest_load = float(stored_loads[np.argmin(np.abs(stored_loads - load))])
        spacing = float(np.min(np.diff(stored_loads)))
        return nearest_load if abs(nearest_load - load) < CLICK_TOLERANCE_IN_SPACINGS * spacing else load

    def _control_values(self, tab: str, name: str) -> Array:
        """Values of the parameter or quantity `name` at all points of the file, (points,), in the unit of the
        control on the tab `tab`. If the file lacks `name`: the default of the parameter, or nan."""
        default = PARAMETERS[name].default if name in PARAMETERS else None
        default_value = nan if default is None else default
        stored_values = self.data[name] if name in self.data.variables else default_value
        at_points = (self.data["status"] * 0.0 + stored_values).transpose(*self.dims)
        values: Array = at_points.values.ravel() * SLIDER_SCALES[tab][name].factor_from_si
        return values

    def _matching_points(self, state: PageState, free_controls: Collection[str] = ()) -> NDArray[np.integer]:
        """Indices, (n,), of the points of the file that have the parameters of `state`. The parameters in
        `free_controls`, and the parameter along a row of a phase diagram, may have any value."""
        is_matching = np.ones(self.data["status"].size, dtype=bool)
        along_rows = {name for name in state.visible_texts if self._has_several_values_per_point(name)}
        for name, text in state.visible_texts.items():
            if name not in free_controls and name not in along_rows:
                value = SLIDER_SCALES[state.tab][name].value(text)
                control_values = self._control_values(state.tab, name)
                is_matching &= np.array(
                    [value is not None and _matches_control(value, number) for number in control_values],
                    dtype=bool,
                )
        return np.flatnonzero(is_matching)

    def _has_several_values_per_point(self, name: str) -> bool:
        """Whether a point of the file is a row of rods with several values of the parameter `name`."""
        return name in self.data.variables and not set(self.data[name].dims) <= set(self.dims)

    def _data_at(self, numbers: NDArray[np.integer]) -> DatasetOrArray:
        """Data at the points with the indices `numbers`, with the dimension `POINT_DIMENSION` for the
        points."""
        if not self.dims:
            return self.data.expand_dims(POINT_DIMENSION)
        return self.data.stack({POINT_DIMENSION: self.dims}, create_index=False).isel(
            {POINT_DIMENSION: numbers}
        )

    def _cycle(self, state: PageState) -> AnswerVariables | None:
        """Stored cycle of the rod of `state`. For a rod that has no cycle according to the file: the straight
        rod if it is uniform and linear, otherwise None. None also if the point or the shapes are missing in
        the file."""
        numbers = self._matching_points(state)
        if len(numbers) == 0 or "shape_x" not in self.data:
            return None
        point = self._data_at(numbers[:1]).isel({POINT_DIMENSION: 0})
        status = str(flag_words(point["status"]))
        F = float(point["F"])
        k1 = float(point["k1"])
        is_drawn = np.isfinite(point["shape_x"].values).all()
        if status == "missing" or (not is_drawn and not (state.law == "linear" and "taper" not in point)):
            return None
        answer: AnswerVariables = {str(name): array.values for name, array in point.variables.items()}
        nodes = point["u"].values
        return answer | {
            "status": status, "sentence": status_sentences_in(self.data.attrs).get(status, ""),
            "message": f"stored in {self.path.name}",
            "units": {str(name): array.attrs["units"] for name, array in point.data_vars.items()},
            "x": (1 - F / k1) * nodes, "y": np.zeros(len(nodes)),
        }  # fmt: skip

    def _cycles_over_force(self, state: PageState) -> AnswerVariables | None:
        """Stored cycles of the rod of `state` at all forces; None if the file has fewer than two such
        points."""
        numbers = self._matching_points(state, (state.load_name,))
        if len(numbers) < 2:
            return None
        line = self._data_at(numbers)
        y = line["tip_y_max"].values
        statuses = flag_words(line["status"])
        y = np.where(statuses == "straight", 0.0, y)
        is_finite = np.isfinite(y)
        stable = np.where(statuses[is_finite] == "unstable", 0, 1)
        cycles = {"F": line["F"].values[is_finite], "y": y[is_finite], "stable": stable}
        return {"pieces": [], "special": [], "cycles": cycles, **self._status_and_source_texts()}

    def _branch(self, state: PageState) -> AnswerVariables | None:
        """Stored branches of the rod of `state` along the force; None if the file has no computed branches of
        this rod."""
        numbers = self._matching_points(state, (state.load_name,))
        if len(numbers) == 0 or "branch_F" not in self.data:
            return None
        rod = int(numbers[0])
        point = self._data_at(numbers[:1]).isel({POINT_DIMENSION: 0})
        if flag_words(point["status"]) == "missing":
            return None
        largest_force = float(json.loads(self.data.attrs["config_resolved"])["branch"]["stop"])
        return (
            branch_answer_of_rod(RodBranches(view_of_dataset(self.data, self.path), rod), largest_force)
            | self._status_and_source_texts()
        )

    def _status_and_source_texts(self) -> AnswerVariables:
        return {"status": "ok", "sentence": "", "source": f"stored in {self.path.name}"}


def _matches_control(value: float, stored: float) -> bool:
    """Whether `value`, from a control, equals the value `stored`, or `stored` rounded to one of the
    CONTROL_DIGITS, up to EQUALITY_TOLERANCE."""
    rounded = [float(f"{stored:.{digits}g}") for digits in CONTROL_DIGITS]
    return any(
        number == value or abs(number - value) <= EQUALITY_TOLERANCE * abs(number)
        for number in (stored, *rounded)
    )
