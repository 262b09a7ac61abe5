"""The task phase_diagram: what the rod does over two parameters, row by row."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from ...config.phase_diagram import PhaseDiagramConfig
from ...config.values import Axis
from ...determinant.parameter_plane import Plane, PlaneAxis
from ...model.parameters import CRUSHING
from ...model.rod import Rod
from ...results.file.view import View
from ...results.layouts.phase_diagram import (
    MOST_SPECIAL,
    bautin_curve_variables,
    criticality_variables,
    curve_variables,
    cycle_curve_variables,
)
from ...results.layouts.variables import Filled
from ...sweep.estimate import Estimate, estimate_branches, estimate_lines
from .diagram_cycles import curves_of_cycles, cycles_record
from .parts import LinearTask
from .protocol import Part, Solver
from .thresholds import search_record

if TYPE_CHECKING:
    from ...determinant.curves import BoundaryCurve
    from ...solve.branch.special_points import SpecialPoint
    from ...solve.changes.boundaries import Boundaries
    from ...solve.changes.rows import DiagramRow, RowRequest
    from ...solve.hopf.bautin_curves import BautinCurve
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
        cycles = "phase_diagram.cycles adds it"
        if options.cycles:
            cycles = f"gamma1 = {self.config.gamma1:g}; cycles on branches from the Hopf points of each row"
        return [
            ("monotone, oscillatory, flutter", True, "task: phase_diagram"),
            ("crossings along each row", True, f"at most {options.crossings} are stored for each row"),
            ("boundaries as curves", options.curves, curves),
            ("criticality of Hopf curves", options.criticality, criticality),
            (
                "curves of generalised Hopf points",
                options.third is not None,
                f"over {options.third[0]}" if options.third else "phase_diagram.bautin_along adds them",
            ),
            ("stable states, with cycles", options.cycles, cycles),
        ]

    def parts(self) -> list[Part]:
        """As of a linear task, but for the cycles, which are motions of the nonlinear rod."""
        linear = LinearTask.parts(self)
        if not self.config.phase_diagram.cycles:
            return linear
        nonlinear = ("nonlinear motion", True, "of the cycles; in the plane, geometrically exact")
        return [*linear[:-1], nonlinear, ("gravity, inertia", False, "not part of the model")]

    def cost(self) -> Estimate:
        options, rows = self.config.phase_diagram, self.points.count
        lines = estimate_lines(rows, options.certify)
        if not options.cycles:
            return lines
        return replace(lines, seconds=lines.seconds + estimate_branches(rows).seconds)

    def solver(self) -> Solver:
        from ...solve.changes.rows import solve_row
        from ...solve.changes.thresholds import ThresholdStatus, warm_up

        options, request = self.config.phase_diagram, self._request()
        if options.cycles:
            return self._with_cycles(request)
        return Solver(
            statuses=tuple(ThresholdStatus),
            warm_up=warm_up,
            solve=lambda index: solve_row(self.points.values(index), request),
            record=lambda index, result: record(result, options.crossings),
            finish=self.curves if options.curves else None,
        )

    def _request(self) -> "RowRequest":
        """What is asked of every row."""
        from ...solve.changes.rows import RowRequest

        options = self.config.phase_diagram
        return RowRequest(
            self.config.plane[0], self.line, self.config.accuracy, options.certify, options.crossings
        )

    def _with_cycles(self, request: "RowRequest") -> Solver:
        """How rows with their cycles are solved."""
        from ...solve.branch.branches import warm_up
        from ...solve.branch.coexistence import CoexistenceStatus, solve_coexistence

        gamma1 = self.config.gamma1
        return Solver(
            statuses=tuple(CoexistenceStatus),
            warm_up=warm_up,
            solve=lambda i: solve_coexistence(self.points.values(i), gamma1, request, MOST_SPECIAL),
            record=lambda index, result: (
                record(result.row, request.crossings) | cycles_record(result, request.name)
            ),
            finish=self.curves if self.config.phase_diagram.curves else None,
        )

    def curves(self, view: View) -> list[Filled]:
        """The boundaries through the crossings of all rows, with their folds, as variables of the file."""
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
        found = self._boundaries(plane, view, rows)
        variables = curve_variables(line, row) | criticality_variables(line, row)
        values, options = curve_record(found, line, row), self.config.phase_diagram
        if (line, row) == CRUSHING:  # the fold of the Hopf curve in the partial beam limit (Sec. VIII)
            from ...solve.changes.thresholds import filament_hopf

            Fc = filament_hopf()
            values |= {"filament_F_hopf": Fc, "partial_beam_k1": 4 * Fc, "partial_beam_F": 2 * Fc}
        told = self._criticality(plane, found) if options.criticality or options.cycles else []
        if options.criticality:
            values |= criticality_record(told, self.config.plane) | {"curve_gamma1": self.config.gamma1}
        if options.third is not None:
            variables |= bautin_curve_variables(line, row, options.third[0])
            values |= self._bautin_curves(plane, told, *options.third)
        if options.cycles:
            variables |= cycle_curve_variables(line, row)
            values |= curves_of_cycles(plane, view, rows, told, self._special_points)
        return [(variables[name], np.asarray(value)) for name, value in values.items()]

    def _boundaries(self, plane: Plane, view: View, rows: np.ndarray) -> "Boundaries":
        """The curves through the crossings of all finite rows, whose values are given, (rows,)."""
        from ...solve.changes.boundaries import curves_through, seed_of

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
        # Where a list is full its last crossings are not stored, and no curve starts from them.
        cut = view.variables["crossing_count"].ravel() - np.count_nonzero(kind, axis=1)
        return replace(found, untraced=found.untraced + int(cut[np.isfinite(rows)].clip(min=0).sum()))

    def _special_points(self, number: int) -> "tuple[SpecialPoint, ...]":
        """The special points of the branches of the row of a number, solved anew."""
        from ...solve.branch.coexistence import row_branches, special_of

        fixed = self.points.values(number)
        return special_of(row_branches(fixed, self.config.gamma1, self._request(), MOST_SPECIAL))

    def _criticality(self, plane: Plane, found: "Boundaries") -> "list[CurveCriticality]":
        """On which side of each curve cycles are born, if it is one of Hopf points."""
        from ...solve.hopf.generalised import CurveCriticality, curve_criticality

        gamma1, accuracy = self.config.gamma1, self.config.accuracy
        return [
            curve_criticality(plane, curve, gamma1, accuracy)
            if curve.hopf
            else CurveCriticality(np.full(len(curve.values), np.nan), (), 0)
            for curve in found.curves
        ]

    def _bautin_curves(
        self, plane: Plane, told: Sequence["CurveCriticality"], name: str, axis: Axis
    ) -> dict[str, Any]:
        """The curves of generalised Hopf points over the third parameter, as variables of the file."""
        from ...solve.hopf.bautin_curves import BautinCurve, BautinSpace, bautin_curve, lies_on, on_curve

        options = self.config
        asked, here = axis.array(), float(options.parameters.axes[name].array()[0])
        third = PlaneAxis(name, float(asked[0]), float(asked[-1]), axis.logarithmic)
        space = BautinSpace(
            plane.rod, (*plane.axes, third), np.append(asked, here), options.gamma1, options.accuracy
        )
        curves: list[BautinCurve] = []
        for point in (on_curve(found, here) for curve in told for found in curve.points):
            if not any(lies_on(space, point, curve) for curve in curves):
                curves.append(bautin_curve(space, point))
        return bautin_curve_record(curves, (*options.plane, name))


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


def bautin_curve_record(curves: Sequence["BautinCurve"], names: tuple[str, ...]) -> dict[str, Any]:
    """Curves of generalised Hopf points as the variables of the file."""
    points = [(number, point) for number, curve in enumerate(curves, 1) for point in curve.points]
    ends = [np.zeros(len(curve.points), dtype=int) for curve in curves]
    for end, curve in zip(ends, curves, strict=True):
        end[[0, -1]] = curve.ends
    values: dict[str, Any] = {
        "bautin_along_curve": [number for number, _ in points],
        "bautin_along_frequency": [point.frequency for _, point in points],
        "bautin_along_landau_imag": [point.landau_imag for _, point in points],
        "bautin_along_end": np.concatenate([np.empty(0, dtype=int), *ends]),
    }
    for place, name in enumerate(names):
        values[f"bautin_along_{name}"] = [point.values[place] for _, point in points]
        values[f"bautin_along_{name}_error"] = [point.errors[place] for _, point in points]
    return values
