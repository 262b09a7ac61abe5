"""Thresholds of the straight rod (onsets of oscillation and changes of stability) along a line of points of a
result file, that is, of points that differ in one parameter only.

The thresholds that the task located are read from the file; nothing is solved or interpolated here. Any other
change of stability is bracketed by two points of the file.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from math import inf, nan

import numpy as np
from numpy.typing import NDArray

from ..model.parameters import OPTIONAL_PARAMETER_NAMES, TRANSVERSE_PARAMETER_NAMES
from ..results.file.view import ResultView
from ..results.layouts.thresholds import CROSSING_KINDS
from ..sweep.points.points import ParameterLine

HOPF_DISTANCE_OF_UNCERTAIN_GROWTH = 1e-9
"""At points of the file that are closer to a Hopf point than this relative distance, the growth rate is
rounding error."""
HOPF_KINDS_CHANGING_STABILITY = {("hopf", 2), ("restabilization", 0)}
"""(kind, number of unstable modes above) of the Hopf points at which the stability of the straight rod
changes. At all other Hopf points the rod is unstable on both sides."""


@dataclass(frozen=True, slots=True)
class LocatedThreshold:
    """Threshold of the straight rod at the parameter value `position`. position_error: absolute error
    estimate.

    kind: `hopf` if a pair of eigenvalues crosses the imaginary axis and the rod is unstable above `position`;
    `restabilization` if the rod is stable above; `onset` if two real eigenvalues merge into a pair while the
    rod stays stable.
    """

    position: float
    position_error: float
    kind: str
    frequency: float = nan
    """Angular frequency of the pair that crosses the imaginary axis, in 1/tau2; NaN if unknown, and for an
    onset."""

    @property
    def changes_stability(self) -> bool:
        """Whether the stability of the straight rod changes at the threshold; False for an onset of
        oscillation."""
        return self.kind != "onset"

    def equals_within_errors(self, point: "LocatedThreshold") -> bool:
        """Whether two located thresholds have equal kinds, and positions that are equal within the errors."""
        return (
            self.kind == point.kind
            and abs(self.position - point.position) <= self.position_error + point.position_error
        )


@dataclass(frozen=True, slots=True)
class BracketedThreshold:
    """Interval between two neighbouring points of a file in which the stability of the straight rod changes.
    low, high: parameter values of the two points."""

    low: float
    high: float
    kind: str
    """`hopf` if the rod is unstable above the interval, `restabilization` if the rod is stable above."""


def lowest_position(change: LocatedThreshold | BracketedThreshold) -> float:
    """Parameter value by which thresholds are sorted: the position, or the lower end of a bracketing
    interval."""
    return change.position if isinstance(change, LocatedThreshold) else change.low


class StoredThresholds:
    """Thresholds of the straight rod along the parameter `name`, as stored in a result file.

    Files of spectra and modes store thresholds along F, with onsets of oscillation. Files of limit cycles
    store Hopf points along any parameter.
    """

    def __init__(self, view: ResultView, name: str):
        variables = view.variables
        point_count = variables["status"].size
        growth_rate_name = "linear_growth_rate" if "linear_growth_rate" in variables else "growth_rate"
        self.growth_rates = variables[growth_rate_name].reshape(point_count, -1)[:, 0]
        missing = {
            optional_parameter
            for optional_parameter in OPTIONAL_PARAMETER_NAMES
            if not {f"hopf_{optional_parameter}", f"change_{optional_parameter}"} & variables.keys()
        }
        self.other_parameters = [
            other_parameter
            for other_parameter in TRANSVERSE_PARAMETER_NAMES
            if other_parameter not in {name, *missing}
        ]
        self.thresholds_by_rod: dict[tuple[float, ...], list[LocatedThreshold]] = {}
        if "hopf_along" in variables:  # a user may have dropped the variable from a Dataset
            self._add_thresholds(
                variables, name, "hopf", variables["hopf_along"] == TRANSVERSE_PARAMETER_NAMES.index(name)
            )
        if "change_kind" in variables and name == "F":
            self._add_thresholds(variables, name, "change", np.ones(len(variables["change_kind"]), bool))

    def _add_thresholds(
        self, variables: Mapping[str, np.ndarray], name: str, prefix: str, is_chosen: NDArray[np.bool_]
    ) -> None:
        """Adds the onsets and changes of stability in the mask `is_chosen`, (changes,), of the variables
        whose names start with `prefix`. name: parameter along which the thresholds are located."""
        rods = np.stack(
            [variables[f"{prefix}_{other_parameter}"] for other_parameter in self.other_parameters], axis=-1
        )
        fields = (name, "error", "frequency", "kind")
        positions, errors, frequency, kinds = (variables[f"{prefix}_{field}"] for field in fields)
        counts = variables["hopf_unstable_after"] if prefix == "hopf" else None
        for i in np.flatnonzero(is_chosen):
            parameter = float(positions[i])
            word = CROSSING_KINDS[int(kinds[i])]
            if word == "onset" or counts is None or (word, int(counts[i])) in HOPF_KINDS_CHANGING_STABILITY:
                absolute_error = float(errors[i]) * (abs(parameter) or 1.0)
                rate = nan if word == "onset" else float(frequency[i])
                point = LocatedThreshold(parameter, absolute_error, word, rate)
                self.thresholds_by_rod.setdefault(tuple(rods[i].tolist()), []).append(point)

    def thresholds_up_to_end(self, line: ParameterLine) -> list[LocatedThreshold | BracketedThreshold]:
        """Thresholds from the start of the search to the largest parameter value of `line`, a line of points
        that differ in one parameter only."""
        return sorted(
            {*self.thresholds_on_line(line), *self._located_between(line, -inf)}, key=lowest_position
        )

    def _located_between(self, line: ParameterLine, low: float) -> list[LocatedThreshold]:
        """Located thresholds between the parameter value `low` and the largest parameter value of `line`, for
        the other parameters of this line."""
        rod = tuple(line.other_parameters[other_parameter] for other_parameter in self.other_parameters)
        high = float(line.values.max(initial=-inf))
        return [point for point in self.thresholds_by_rod.get(rod, []) if _lies_between(point, low, high)]

    def thresholds_on_line(self, line: ParameterLine) -> list[LocatedThreshold | BracketedThreshold]:
        """Thresholds on a line of points, which differ in one parameter only, by increasing parameter; an
        empty list for a line without points.

        Two neighbouring points bracket a change of stability that a failed search did not locate, if their
        growth rates differ in sign and the number of located changes of stability between them is even.
        """
        if not len(line.values):
            return []
        stored_thresholds = self._located_between(line, float(line.values.min()))
        thresholds: list[LocatedThreshold | BracketedThreshold] = [*stored_thresholds]
        changes = [point for point in stored_thresholds if point.changes_stability]
        finite_indices = np.flatnonzero(np.isfinite(self.growth_rates[line.indices]))
        sorted_indices = finite_indices[np.argsort(line.values[finite_indices], kind="stable")]
        x = line.values[sorted_indices]
        is_growing = self.growth_rates[line.indices[sorted_indices]] > 0
        for i in np.flatnonzero(is_growing[1:] != is_growing[:-1]):
            low = float(x[i])
            high = float(x[i + 1])
            kind = "hopf" if is_growing[i + 1] else "restabilization"
            if sum(_lies_between(point, low, high) for point in changes) % 2 == 0:
                thresholds.append(BracketedThreshold(low, high, kind))
        return sorted(thresholds, key=lowest_position)


def _lies_between(point: LocatedThreshold, low: float, high: float) -> bool:
    """Whether a located threshold lies between `low` and `high`, within its error or rounding error."""
    margin = max(point.position_error, HOPF_DISTANCE_OF_UNCERTAIN_GROWTH * abs(point.position))
    return bool(low - margin <= point.position <= high + margin)
