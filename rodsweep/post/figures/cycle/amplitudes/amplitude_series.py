"""Limit cycles of a file as curves against a parameter: amplitudes of the tip, periods and powers."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .....arrays import Array
from .....errors import InputError
from .....results.file.view import ResultView
from .....results.layouts.limit_cycle import STATUS_NAMES_WITH_CYCLE
from .....sweep.points.points import lines_along
from ....located_thresholds import LocatedThreshold, StoredThresholds
from ..units_and_labels import DIMENSIONLESS_UNITS, CycleUnits


@dataclass(frozen=True, slots=True)
class AmplitudeSeries:
    """Limit cycles of the file `view` at points that differ in one parameter x, in the order of the file.

    Arrays have the shape (points,). amplitude_x: (x_max - x_min)/2 of the tip. tip_y_max: largest y of the
    tip. Amplitudes, period and power of points without a cycle are NaN; the amplitudes of a straight rod are
    0.
    """

    view: ResultView
    constant_parameters: dict[str, float]
    """Parameters with the same value at all points of the series, by name."""
    x: Array
    amplitude_x: Array
    tip_y_max: Array
    period: Array
    injection_mean: Array
    """Mean power of the follower force over a period."""
    status_names: NDArray[np.str_]
    """Status of each point, as a word."""
    hopf_points: list[LocatedThreshold]
    """Hopf points of the straight rod in the range of x; empty unless x is F."""
    units: CycleUnits
    """Units of all drawn quantities."""
    first_point_number: int
    """Number, in the file, of the first point of the series, counted from 1."""

    @property
    def drawn_quantities(self) -> tuple[Array, ...]:
        """Quantities drawn in the panels, in the order of `CycleUnits.panel_labels`."""
        return self.amplitude_x, self.tip_y_max, self.period, self.injection_mean

    def x_and_values_with_gaps(self, values: Array) -> tuple[Array, Array]:
        """Returns (x, values) with NaN inserted between neighbouring points of which only one is straight,
        because a line between these points would suggest a slope. values: (points,)."""
        straight = self.status_names == "straight"
        change = np.flatnonzero(straight[1:] != straight[:-1]) + 1
        return np.insert(self.x, change, np.nan), np.insert(values, change, np.nan)


def abscissa_parameter(view: ResultView) -> str:
    """Name of the parameter on the horizontal axis: F, or the parameter with the most values if F is
    constant. Raises InputError for a file with one point."""
    value_counts = {name: len(np.unique(column)) for name, column in view.point_columns.items()}
    name = "F" if value_counts["F"] > 1 else max(value_counts, key=value_counts.__getitem__)
    if value_counts[name] < 2:
        raise InputError(f"{view.path} holds one point; amplitudes need several values of a parameter")
    return name


def amplitude_series(
    view: ResultView, name: str, units: CycleUnits = DIMENSIONLESS_UNITS
) -> list[AmplitudeSeries]:
    """Curves of a file against the parameter `name`, one for each combination of the other parameters. units:
    units of the drawn quantities."""
    statuses = view.status_names
    variables = view.variables
    straight = statuses == "straight"
    cycle = np.isin(statuses, STATUS_NAMES_WITH_CYCLE)
    x_amplitudes = (variables["tip_x_max"] - variables["tip_x_min"]).ravel() / 2
    x_values, y_values = (
        units.length * np.where(straight, 0.0, np.where(cycle, values, np.nan))
        for values in (x_amplitudes, variables["tip_y_max"].ravel())
    )
    period = units.time * np.where(cycle, variables["period"].ravel(), np.nan)
    power = units.power * np.where(cycle, variables["injection_mean"].ravel(), np.nan)
    all_series = []
    stored_thresholds = StoredThresholds(view, "F")
    for line in lines_along(view.point_columns, name):
        changes = stored_thresholds.thresholds_on_line(line) if name == "F" else []
        indices = line.indices
        hopf_points = [
            change for change in changes if isinstance(change, LocatedThreshold) and change.changes_stability
        ]
        all_series.append(
            AmplitudeSeries(
                view=view,
                constant_parameters=line.other_parameters,
                x=line.values,
                amplitude_x=x_values[indices],
                tip_y_max=y_values[indices],
                period=period[indices],
                injection_mean=power[indices],
                status_names=statuses[indices],
                hopf_points=hopf_points,
                units=units,
                first_point_number=int(indices[0]) + 1,
            )
        )
    return all_series
