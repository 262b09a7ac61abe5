"""Computation of the curves of a phase diagram, which need the results of all rows."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from ...config.axis import Axis
from ...model.parameters import CRUSHING_PARAMETERS
from ...model.rod import Rod
from ...results.file.view import View
from ...results.layouts.phase_diagram import MAX_CYCLE_SPECIAL_POINTS
from ...results.layouts.variables import FilledVariable
from .curve_variables import (
    bautin_curve_values,
    boundary_curve_values,
    criticality_record,
    cycle_curve_values,
    special_points_of_rows,
    unstored_special_count,
    with_hopf_ends,
)

if TYPE_CHECKING:
    from ...determinant.parameter_plane import Plane
    from ...solve.branch.coexistence import CoexistenceRow
    from ...solve.branch.special.special_curve_tracer import SpecialCurveTracer
    from ...solve.branch.special.special_point import SpecialPoint
    from ...solve.changes.diagram.boundary_curves import BoundaryCurve
    from ...solve.continuation.curve_search import TracedCurves
    from ...solve.hopf.bautin_points import CurveCriticality
    from ...solve.orbit.matrix.workspace import NewtonWorkspace
    from ..phase_diagram import PhaseDiagramTask

MAX_CACHED_ROWS = 200
"""Maximum number of rows whose special points are cached in a process, because the cycles of a row take up to
a megabyte. Special points of further rows are computed again, in some seconds and with equal results."""


@dataclass(slots=True, eq=False)
class DiagramCurves:
    """Computes the curves of a phase diagram after its rows are solved.

    The curves are boundaries of stability with their criticality, curves of generalised Hopf points, and
    curves of folds and torus points of cycles. Only the last kind of curves, which takes most of the time, is
    divided among the ranks, into half curves.
    """

    task: "PhaseDiagramTask"
    workspace: "NewtonWorkspace"
    """Buffers of Newton's matrices in this process."""
    special_points_by_row: "dict[int, tuple[SpecialPoint, ...]]" = field(default_factory=dict)
    """Special points of cycles by the number of their row, for rows solved in this process."""

    def cache_row(self, number: int, row: "CoexistenceRow") -> "CoexistenceRow":
        """Returns `row` unchanged, after caching its special points if fewer than MAX_CACHED_ROWS rows are
        cached. number: number of the row.
        """
        if len(self.special_points_by_row) < MAX_CACHED_ROWS:
            self.special_points_by_row[number] = row.special_points
        return row

    def initial_data(self, items: "SpecialCurveTracer", chosen: Sequence[int]) -> "dict[int, Any]":
        """Special points cached on this rank, by number of the row, for the rows on which the half curves
        numbered `chosen` start. items: all half curves.
        """
        rows = {items.row_of(item) for item in chosen}
        return {row: self.special_points_by_row[row] for row in rows if row in self.special_points_by_row}

    def add_initial_data(self, starts: "Mapping[int, Any]") -> None:
        """Caches special points of rows solved on other ranks. starts: special points by number of the
        row.
        """
        self.special_points_by_row.update(starts)

    def work_items(self, view: View) -> "SpecialCurveTracer | None":
        """Curves of folds and torus points of cycles, divided into half curves; None if these curves are not
        requested, or if fewer than two rows have a finite value.

        view: the result file with all rows.
        """
        from ...solve.branch.special.special_curve_tracer import SpecialCurveTracer

        plane = self.plane if self.task.config.phase_diagram.cycles else None
        if plane is None:
            return None
        row = self.task.config.plane_parameters[1]
        special = special_points_of_rows(view, plane.axes[0].name, self.task.points.columns_by_name[row])
        return SpecialCurveTracer(*plane.axes, special)

    def solve_item(self, items: "SpecialCurveTracer", item: int) -> dict[str, np.ndarray]:
        """Result of the half curve number `item`, as arrays with the shapes of `TracedHalfCurve`."""
        return items.solve(item, self._special_points, self.workspace)

    def empty_result(self) -> dict[str, np.ndarray]:
        """Result of a half curve without points: arrays of shape (0, ...)."""
        from ...solve.branch.special.special_curves import TracedHalfCurve

        return TracedHalfCurve(None).arrays()

    def variables(
        self, view: View, items: "SpecialCurveTracer | None", results: Mapping[int, dict[str, np.ndarray]]
    ) -> list[FilledVariable]:
        """All curves as variables of the file; an empty list if there are no curves, because `plane` is None.
        view: the file with all rows. results: results of all half curves by number, with shapes as in
        `TracedHalfCurve`."""
        plane = self.plane
        if plane is None:
            return []
        line, row = self.task.config.plane_parameters
        names = (line, row)
        options = self.task.config.phase_diagram
        found = self._boundaries(plane, view, self.task.points.columns_by_name[row])
        limit = {}
        if names == CRUSHING_PARAMETERS and self.task.config.is_uniform_and_linear:
            # The fold of the Hopf curve in the partial beam limit (Sec. VIII).
            from ...solve.changes.thresholds import filament_flutter_force

            Fc = filament_flutter_force()
            limit = {"filament_F_hopf": Fc, "partial_beam_k1": 4 * Fc, "partial_beam_F": 2 * Fc}
        variables = boundary_curve_values(found, names, **limit)
        criticalities = self._criticality(plane, found) if options.criticality or options.cycles else []
        if options.criticality:
            variables += criticality_record(criticalities, names, self.task.config.gamma1)
        if options.bautin_parameter is not None:
            variables += self._bautin_curves(plane, criticalities, *options.bautin_parameter)
        if items is not None:
            curves = with_hopf_ends(
                items.curves(results), plane, criticalities, unstored_special_count(view, self._is_row_finite)
            )
            variables += cycle_curve_values(curves, names)
        return variables

    @property
    def _is_row_finite(self) -> np.ndarray:
        """Whether the value of the row's parameter is finite, (rows,)."""
        return np.isfinite(self.task.points.columns_by_name[self.task.config.plane_parameters[1]])

    @property
    def plane(self) -> "Plane | None":
        """Plane of the diagram's two parameters; None if fewer than two rows have a finite value."""
        from ...determinant.parameter_plane import Plane, PlaneAxis

        line, row = self.task.config.plane_parameters
        finite = self.task.points.columns_by_name[row][self._is_row_finite]
        if len(finite) < 2:
            return None
        axes = self.task.config.parameters.axes
        # A rod of the plane must be valid: take the corner of the grid that is farthest from crushing.
        not_crushed: dict[str, Any] = {
            name: float(axis.array()[-1 if name in ("k1", "taper") else 0]) for name, axis in axes.items()
        }
        abscissa, ordinate = (
            PlaneAxis(name, float(values[0]), float(values[-1]), axes[name].is_logarithmic)
            for name, values in ((line, self.task.line_values), (row, finite))
        )
        rod = Rod(**not_crushed, gamma1=self.task.config.gamma1, build=self.task.config.build)
        return Plane(rod, (abscissa, ordinate))

    def _boundaries(self, plane: "Plane", view: View, rows: np.ndarray) -> "TracedCurves[BoundaryCurve]":
        """Boundary curves through the crossings of all rows with a finite value. rows: parameter value of
        every row, (rows,).
        """
        from ...solve.changes.diagram.boundaries import boundary_curves_through, seed_of

        names = ("crossing_at", "crossing_kind", "crossing_frequency", "crossing_growth_rate")
        at, kind, frequency, rate = map(view.by_point, names)
        seeds = [
            seed_of(
                (float(at[i, j]), float(rows[i])), int(kind[i, j]), float(frequency[i, j]), float(rate[i, j])
            )
            for i in np.flatnonzero(np.isfinite(rows))
            for j in np.flatnonzero(kind[i])
        ]
        found = boundary_curves_through(plane, [seed for seed in seeds if seed is not None])
        # If a list is full, its last crossings are not stored, and no curve starts from them.
        cut = view.variables["crossing_count"].ravel() - np.count_nonzero(kind, axis=1)
        return replace(
            found, untraced_count=found.untraced_count + int(cut[np.isfinite(rows)].clip(min=0).sum())
        )

    def _special_points(self, number: int) -> "tuple[SpecialPoint, ...]":
        """Special points of the branches of the row `number`, cached or computed again."""
        from ...solve.branch.coexistence import row_branches, special_points_of

        if number not in self.special_points_by_row:
            request = self.task.row_request()
            return special_points_of(
                row_branches(self.task.rod_of_row(number), request, MAX_CYCLE_SPECIAL_POINTS, self.workspace)
            )
        return self.special_points_by_row[number]

    def _criticality(self, plane: "Plane", found: "TracedCurves[BoundaryCurve]") -> "list[CurveCriticality]":
        """Criticality along each curve; NaN along curves that are not Hopf curves."""
        from ...solve.hopf.bautin_points import CurveCriticality, curve_criticality

        accuracy = self.task.config.accuracy
        return [
            curve_criticality(plane, curve, accuracy)
            if curve.consists_of_hopf_points
            else CurveCriticality(np.full(len(curve.values), np.nan), (), 0)
            for curve in found.curves
        ]

    def _bautin_curves(
        self, plane: "Plane", criticalities: Sequence["CurveCriticality"], name: str, axis: Axis
    ) -> list[FilledVariable]:
        """Curves of generalised Hopf points along the third parameter `name`, as variables of the file. axis:
        values of the third parameter. criticalities: as from `_criticality`.
        """
        from ...determinant.parameter_plane import PlaneAxis
        from ...solve.hopf.bautin_curves import (
            BautinCurve,
            BautinProblem,
            as_curve_point,
            bautin_curve,
            lies_on_curve,
        )

        line, row = self.task.config.plane_parameters
        values = axis.array()
        value_in_plane = float(getattr(plane.rod, name))
        third = PlaneAxis(name, float(values[0]), float(values[-1]), axis.is_logarithmic)
        all_values = np.append(values, value_in_plane)
        space = BautinProblem(plane.rod, (*plane.axes, third), all_values, self.task.config.accuracy)
        curves: list[BautinCurve] = []
        for start in [
            as_curve_point(found, value_in_plane) for curve in criticalities for found in curve.points
        ]:
            # A curve may return to the plane: its further points need no curve of their own.
            if not any(lies_on_curve(space, start, curve) for curve in curves):
                curves.append(bautin_curve(space, start))
        return bautin_curve_values(curves, (line, row), name)
