"""The task phase_diagram: what the rod does over two parameters, row by row."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from ...config.phase_diagram import PhaseDiagramConfig
from ...determinant.parameter_plane import Plane, PlaneAxis
from ...model.parameters import CRUSHING
from ...model.rod import Rod
from ...results.file.view import View
from ...results.layouts.phase_diagram import criticality_variables, curve_variables
from ...results.layouts.variables import Filled
from ...sweep.estimate import Estimate, estimate_lines
from .parts import LinearTask
from .protocol import Part, Solver
from .thresholds import search_record

if TYPE_CHECKING:
    from ...determinant.curves import BoundaryCurve
    from ...solve.changes.boundaries import Boundaries
    from ...solve.changes.rows import DiagramRow
    from ...solve.hopf.generalised import CurveCriticality


@dataclass(frozen=True, slots=True)
class PhaseDiagramTask(LinearTask):
    """A phase diagram; its points are the rows, each a line of values of the first of its two parameters."""

    config: PhaseDiagramConfig

    not_proved: ClassVar[str] = "crossings may be missed"

    @property
    def line(self) -> np.ndarray:
        """Values along every row, shape (values,)."""
        return self.config.parameters.axes[self.config.plane[0]].array()

    def coordinates(self) -> dict[str, np.ndarray]:
        """The values along every row, shape (values,)."""
        return {self.config.plane[0]: self.line}

    def headline(self) -> str:
        line, row = self.config.plane
        return f"{self.points.count} rows, one for each {row}, of {len(self.line)} values of {line} each"

    def asked(self) -> list[Part]:
        options = self.config.phase_diagram
        curves = "followed from row to row" if options.curves else "phase_diagram.curves: false"
        criticality = "phase_diagram.criticality adds it"
        if options.criticality:
            criticality = (
                f"gamma1 = {self.config.gamma1:g}; some 10 ms a point of a Hopf curve, after the rows"
            )
        return [
            ("monotone, oscillatory, flutter", True, "task: phase_diagram"),
            ("crossings along each row", True, f"at most {options.crossings} are stored for each row"),
            ("boundaries as curves", options.curves, curves),
            ("criticality of Hopf curves", options.criticality, criticality),
        ]

    def cost(self) -> Estimate:
        return estimate_lines(self.points.count, self.config.phase_diagram.certify)

    def solver(self) -> Solver:
        from ...solve.changes.rows import RowRequest, solve_row
        from ...solve.changes.thresholds import ThresholdStatus, warm_up

        options = self.config.phase_diagram
        request = RowRequest(
            self.config.plane[0], self.line, self.config.accuracy, options.certify, options.crossings
        )
        return Solver(
            statuses=tuple(ThresholdStatus),
            warm_up=warm_up,
            solve=lambda index: solve_row(self.points.values(index), request),
            record=lambda index, result: record(result, options.crossings),
            finish=self.curves if options.curves else None,
        )

    def curves(self, view: View) -> list[Filled]:
        """The boundaries through the crossings of all rows, with their folds, as variables of the file."""
        from ...solve.changes.boundaries import curves_through, seed_of
        from ...solve.changes.thresholds import filament_hopf

        line, row = self.config.plane
        rows = self.points.by_name[row]
        finite = rows[np.isfinite(rows)]
        if len(finite) < 2:
            return []
        axes = self.config.parameters.axes
        not_crushed = {name: float(axis.array()[-1 if name == "k1" else 0]) for name, axis in axes.items()}
        abscissa, ordinate = (
            PlaneAxis(name, float(values[0]), float(values[-1]), axes[name].logarithmic)
            for name, values in ((line, self.line), (row, finite))
        )
        plane = Plane(Rod(**not_crushed), (abscissa, ordinate))
        names = ("crossing_at", "crossing_kind", "crossing_frequency", "crossing_growth_rate")
        at, kind, frequency, rate = (view.variables[n].reshape(len(rows), -1) for n in names)
        seeds = [
            seed_of(
                (float(at[i, j]), float(rows[i])), int(kind[i, j]), float(frequency[i, j]), float(rate[i, j])
            )
            for i in np.flatnonzero(np.isfinite(rows))
            for j in np.flatnonzero(kind[i])
        ]
        found = curves_through(plane, [seed for seed in seeds if seed is not None])
        variables = curve_variables(line, row) | criticality_variables(line, row)
        # Where a list is full its last crossings are not stored, and no curve starts from them.
        cut = view.variables["crossing_count"].ravel() - np.count_nonzero(kind, axis=1)
        found = replace(found, untraced=found.untraced + int(cut[np.isfinite(rows)].clip(min=0).sum()))
        values = curve_record(found, line, row)
        if (line, row) == CRUSHING:  # the fold of the Hopf curve in the partial beam limit (Sec. VIII)
            Fc = filament_hopf()
            values |= {"filament_F_hopf": Fc, "partial_beam_k1": 4 * Fc, "partial_beam_F": 2 * Fc}
        if self.config.phase_diagram.criticality:
            values |= self._criticality(plane, found)
        return [(variables[name], np.asarray(value)) for name, value in values.items()]

    def _criticality(self, plane: Plane, found: "Boundaries") -> dict[str, Any]:
        """On which side of each Hopf curve cycles are born, as variables of the file."""
        from ...solve.hopf.generalised import CurveCriticality, curve_criticality

        gamma1, accuracy = self.config.gamma1, self.config.accuracy
        told = [
            curve_criticality(plane, curve, gamma1, accuracy)
            if curve.hopf
            else CurveCriticality(np.full(len(curve.values), np.nan), (), 0)
            for curve in found.curves
        ]
        return criticality_record(told, self.config.plane) | {"curve_gamma1": gamma1}


def record(result: "DiagramRow", most: int) -> dict[str, Any]:
    """A row as the variables of the file."""
    classes = {"class": result.motion, "unstable_count": result.unstable_count}
    return classes | search_record(result.changes, most, "crossing_at") | {"seconds": result.seconds}


def curve_record(found: "Boundaries", line: str, row: str) -> dict[str, Any]:
    """Curves and folds as the variables of the file."""
    curves = found.curves
    folds = [(number, curve.hopf, fold) for number, curve in enumerate(curves, 1) for fold in curve.folds]
    points = np.concatenate([curve.values for curve in curves]) if curves else np.empty((0, 2))

    def along(of: Callable[["BoundaryCurve"], Any]) -> list[np.ndarray]:
        return [np.broadcast_to(of(curve), len(curve.values)) for curve in curves] or [np.empty(0)]

    values: dict[str, Any] = {
        "curve_number": np.repeat(np.arange(1, len(curves) + 1), [len(c.values) for c in curves]),
        "curve_kind": np.concatenate(along(lambda c: c.hopf)),
        "curve_frequency": np.concatenate(along(lambda c: c.frequency)),
        "curve_growth_rate": np.concatenate(along(lambda c: c.growth_rate)),
        "fold_curve": [number for number, _, _ in folds],
        "fold_kind": [hopf for _, hopf, _ in folds],
        "fold_of": [fold.axis for _, _, fold in folds],
        "fold_frequency": [fold.frequency for _, _, fold in folds],
        "fold_growth_rate": [fold.growth_rate for _, _, fold in folds],
        "curve_agreement": found.agreement,
        "curves_untraced": found.untraced,
    }
    for place, name in enumerate((line, row)):
        values[f"curve_{name}"] = points[:, place]
        values[f"fold_{name}"] = [fold.values[place] for _, _, fold in folds]
        values[f"fold_{name}_error"] = [fold.errors[place] for _, _, fold in folds]
    return values


def criticality_record(told: Sequence["CurveCriticality"], along: tuple[str, ...]) -> dict[str, Any]:
    """What was found along each curve, in their order, as the variables of the file."""
    starts = np.cumsum([0, *(len(curve.criticality) for curve in told)])
    found = [
        (number, int(starts[number - 1]), point)
        for number, curve in enumerate(told, 1)
        for point in curve.points
    ]
    values: dict[str, Any] = {
        "curve_criticality": np.concatenate([np.empty(0), *(curve.criticality for curve in told)]),
        "bautin_curve": [number for number, _, _ in found],
        "bautin_curve_point": [start + point.after for _, start, point in found],
        "bautin_frequency": [point.frequency for _, _, point in found],
        "bautin_growth_slope_real": [point.growth_slope.real for _, _, point in found],
        "bautin_growth_slope_imag": [point.growth_slope.imag for _, _, point in found],
        "bautin_landau_imag": [point.landau_imag for _, _, point in found],
        "bautin_unlocated": sum(curve.unlocated for curve in told),
    }
    for place, name in enumerate(along):
        values[f"bautin_{name}"] = [point.values[place] for _, _, point in found]
        values[f"bautin_{name}_error"] = [point.errors[place] for _, _, point in found]
    return values
