"""Answers from a result file, so that nothing is solved again: diagram, cycles and branches."""

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from ..api.dataset import view_of
from ..config.axes import DEFAULTS
from ..post.branch_curves import curves_of
from .solving.branches import drawn_branches, straight_pieces
from .solving.diagrams import Dataset, code_of
from .state import ROD, PageState, number

Found = dict[str, Any]
SAME = 1e-5
"""Relative difference below which a value of the page, with five digits, equals a value of the file."""
NEAR = 0.25
"""Distance within which a click means a stored load, as a fraction of the distance between stored loads."""


class StoredResults:
    """A result file of rods on a grid, or of arms; a file of arms provides only the diagram.

    state: state of the page opened by the file. diagram: answer to the question `diagram` in this state, or
    None.
    """

    def __init__(self, path: Path, data: Dataset, state: PageState, diagram: Found | None):
        self.path, self.data, self.state, self.diagram = path, data, state, diagram
        points = data["status"].dims
        self.has_cycles = "tip_y_max" in data and data["tip_y_max"].dims == points
        """Whether each point has one cycle."""

    def answer(self, kind: str, state: PageState) -> Found | None:
        """The stored answer to a question about a state; None if the answer is not in the file."""
        if state.tab != "rod" or self.state.tab != "rod" or state.law != self.state.law:
            return None
        if kind == "cycle":
            return self._cycle(state) if self.has_cycles else None
        if kind == "branch":
            return self._cycles_over_force(state) if self.has_cycles else self._branch(state)
        return None

    def load_near(self, F: float) -> float:
        """The stored force that a click at F means, or F itself."""
        if not self.has_cycles or self.data.sizes.get("F", 1) < 2:
            return F
        stored = self.data["F"].values
        nearest = float(stored[np.argmin(np.abs(stored - F))])
        spacing = float(np.min(np.abs(np.diff(stored))))
        return nearest if abs(nearest - F) < NEAR * spacing else F

    def _place(self, state: PageState, free: Sequence[str] = ()) -> dict[str, int] | None:
        """Index of a state along each axis of the file except the free axes; None for a rod not in the
        file."""
        place = {}
        for name, default in ROD.items():
            if name in free:
                continue
            value = number(state.rod[name])
            is_axis = name in self.data.dims
            own = self.data[name].values if is_axis else np.array([DEFAULTS.get(name, float(default))])
            same = [i for i, each in enumerate(own) if each == value or abs(each - value) <= SAME * abs(each)]
            if not same:
                return None
            if is_axis:
                place[name] = same[0]
        return place

    def _cycle(self, state: PageState) -> Found | None:
        """The stored cycle of a rod, if its shapes are stored too."""
        place = self._place(state)
        if place is None or "shape_x" not in self.data:
            return None
        point = self.data.isel(place)
        status = _word(point["status"])
        F, k1 = float(point["F"]), float(point["k1"])
        is_drawn = np.isfinite(point["shape_x"].values).all()
        if status == "missing" or (not is_drawn and not (state.law == "linear" and "taper" not in point)):
            return None
        found: Found = {str(name): array.values for name, array in point.variables.items()}
        u = point["u"].values
        return found | {
            "status": status, "sentence": self._sentence(status), "message": f"stored in {self.path.name}",
            "units": {str(name): array.attrs["units"] for name, array in point.data_vars.items()},
            "x": (1 - F / k1) * u, "y": np.zeros(len(u)),
        }  # fmt: skip

    def _cycles_over_force(self, state: PageState) -> Found | None:
        """The stored cycles of a rod at all forces, at least two."""
        place = self._place(state, ("F",))
        if place is None or self.data.sizes.get("F", 1) < 2:
            return None
        line = self.data.isel(place)
        y, status = line["tip_y_max"].values, line["status"]
        at_rest = status.values == code_of(status, "straight")
        y = np.where(at_rest, 0.0, y)
        known = np.isfinite(y)
        unstable = status.values[known] == code_of(status, "unstable")
        cycles = {"F": line["F"].values[known], "y": y[known], "stable": np.where(unstable, 0, 1)}
        return {"pieces": [], "special": [], "cycles": cycles, **self._found()}

    def _branch(self, state: PageState) -> Found | None:
        """The stored branches of a rod along the force."""
        place = self._place(state, ("F",))
        if place is None or "branch_F" not in self.data:
            return None
        point = self.data.isel(place)
        if _word(point["status"]) == "missing":
            return None
        sizes = [self.data.sizes[name] for name in self.data["status"].dims]
        index = [place[str(name)] for name in self.data["status"].dims]
        rod = int(np.ravel_multi_index(index, sizes)) if sizes else 0
        stop = float(json.loads(self.data.attrs["config_resolved"])["branch"]["stop"])
        drawn = drawn_branches(curves_of(view_of(self.data, self.path), rod))
        drawn["pieces"] += straight_pieces(point, stop)
        return drawn | self._found()

    def _found(self) -> Found:
        return {"status": "ok", "sentence": "", "source": f"stored in {self.path.name}"}

    def _sentence(self, status: str) -> str:
        lines = str(self.data.attrs["status_sentences"]).splitlines()
        return dict(line.split(": ", 1) for line in lines).get(status, "")


def _word(status: Dataset) -> str:
    """Word of one status."""
    words = str(status.attrs["flag_meanings"]).split()
    codes = list(map(int, np.atleast_1d(status.attrs["flag_values"])))
    return words[codes.index(int(status))]
