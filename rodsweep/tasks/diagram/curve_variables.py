"""Conversion of the curves and cycles of a phase diagram into variables of the result file.

`rodsweep.results.layouts` declares the variables. A row of the diagram contains the rods that differ only in
its first parameter. In every function, `plane` is the pair of names (first parameter, parameter that differs
between rows).
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from math import isnan
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

import numpy as np

from ...results.file.view import ResultView
from ...results.layouts.bautin_points import bautin_curve_variables, criticality_variables
from ...results.layouts.fold_curve_extrema import UNLOCATED_EXTREMA_VARIABLE, fold_curve_extremum_variables
from ...results.layouts.phase_diagram import (
    CYCLE_SPECIAL_DIMENSION,
    MAX_CYCLE_SPECIAL_POINTS,
    boundary_curve_variables,
    cycle_curve_variables,
    cycle_row_variables,
)
from ...results.layouts.variables import FilledVariable, Variable, outcome_values, value_lists

if TYPE_CHECKING:
    from ...determinant.parameter_plane import ParameterPlane
    from ...solve.branch.coexistence import CoexistenceRow
    from ...solve.branch.special.special_curves import SpecialPointCurve
    from ...solve.changes.diagram.boundary_curves import BoundaryCurve
    from ...solve.continuation.curves_through_seeds import TracedCurves
    from ...solve.hopf.bautin_curves import BautinCurve
    from ...solve.hopf.bautin_points import CurveCriticality


def fold_curve_extremum_values(
    traced: "TracedCurves[SpecialPointCurve]", plane: tuple[str, str]
) -> list[FilledVariable]:
    """Variables of the points at which the parameter that differs between rows is extremal along the curves
    `traced`, and number of such points that were not located; [] if there are none. plane: see the module."""
    points = [(number, p) for number, curve in enumerate(traced.curves, 1) for p in curve.points]
    rows = [
        (number, p.parameter_value, p.row_parameter_value, p.error, row_error)
        for number, p in points
        if (row_error := p.row_parameter_error_at_extremum) > 0
    ]
    variables = fold_curve_extremum_variables(*plane).values() if rows else ()
    columns = zip(variables, zip(*rows, strict=True), strict=True)
    filled = [(variable, np.array(column)) for variable, column in columns]
    unlocated_count = sum(isnan(p.row_parameter_error_at_extremum) for _, p in points)
    return filled + ([(UNLOCATED_EXTREMA_VARIABLE, np.array(unlocated_count))] if unlocated_count else [])


def boundary_curve_values(
    traced: "TracedCurves[BoundaryCurve]", plane: tuple[str, str], **limit_values: Any
) -> list[FilledVariable]:
    """Variables of the boundary curves and of their folds. plane: (parameter along a row, parameter that
    differs between rows). limit_values: values of the variables on the partial beam limit (k2 = inf, gamma3 =
    0), by name."""
    points = []
    folds = []
    for number, curve in enumerate(traced.curves, 1):
        arrays = np.broadcast_arrays(
            curve.frequency, curve.growth_rate, curve.parameter_values[:, 0], curve.parameter_values[:, 1]
        )
        for *numbers, reasons in zip(
            *arrays, _end_reasons(curve.end_reasons, len(curve.parameter_values)), strict=True
        ):
            columns = dict(zip(("frequency", "growth_rate", *plane), numbers, strict=True)) | reasons
            points.append((SimpleNamespace(number=number, kind=curve.consists_of_hopf_points, **columns),))
        folds += [
            _named_values_and_point(
                fold, plane, curve=number, kind=curve.consists_of_hopf_points, of=fold.axis
            )
            for fold in curve.folds
        ]
    declared = boundary_curve_variables(*plane)
    values = _values_along_dimension(declared, "curve_point", "curve_", points)
    values |= _values_along_dimension(declared, "fold", "fold_", folds)
    values |= {
        "curve_agreement": traced.max_seed_distance_per_row_length,
        "curves_untraced": traced.untraced_seed_count,
    }
    return _variables_with_values(declared, values | limit_values)


def criticality_and_bautin_values(
    criticalities: Sequence["CurveCriticality"], plane: tuple[str, str], gamma1: float
) -> list[FilledVariable]:
    """Variables of the criticality along each boundary curve, and of the generalised Hopf points.
    criticalities: criticality of each boundary curve, in order. plane: (parameter along a row, parameter that
    differs between rows). gamma1: axial drag of all rods.
    """
    rows = []
    start = 0
    for number, curve in enumerate(criticalities, 1):
        for point in curve.bautin_points:
            rows.append(
                _named_values_and_point(
                    point, plane, curve=number, curve_point=start + point.preceding_index + 1
                )
            )
        start += len(curve.criticality)
    variables = criticality_variables(*plane)
    values = _values_along_dimension(variables, "bautin", "bautin_", rows) | {
        "curve_criticality": np.concatenate([np.empty(0), *(curve.criticality for curve in criticalities)]),
        "bautin_unlocated": sum(curve.unlocated_sign_change_count for curve in criticalities),
        "curve_gamma1": gamma1,
    }
    return _variables_with_values(variables, values)


def bautin_curve_values(
    curves: Sequence["BautinCurve"], plane: tuple[str, str], third_parameter: str
) -> list[FilledVariable]:
    """Variables of the curves of generalised Hopf points along the third parameter `third_parameter`. plane:
    (parameter along a row, parameter that differs between rows).
    """
    rows = [
        _named_values_and_point(point, (*plane, third_parameter), curve=number, **reasons)
        for number, curve in enumerate(curves, 1)
        for point, reasons in zip(
            curve.points, _end_reasons(curve.end_reasons, len(curve.points)), strict=True
        )
    ]
    variables = bautin_curve_variables(*plane, third_parameter)
    return _variables_with_values(
        variables, _values_along_dimension(variables, "bautin_step", "bautin_along_", rows)
    )


def fold_and_torus_curve_values(
    traced: "TracedCurves[SpecialPointCurve]", plane: tuple[str, str]
) -> list[FilledVariable]:
    """Variables of the curves of folds and torus points of cycles, with the Hopf points at their ends. plane:
    (parameter along a row, parameter that differs between rows).
    """
    rows: list[tuple[Any, ...]] = []
    for number, curve in enumerate(traced.curves, 1):
        start, end = ([point] if point else [] for point in curve.hopf_ends)
        points: list[Any] = [*start, *curve.points, *end]
        for point, reasons in zip(points, _end_reasons(curve.end_reasons, len(points)), strict=True):
            columns = (
                dict(zip(plane, (point.parameter_value, point.row_parameter_value), strict=True)) | reasons
            )
            rows.append((SimpleNamespace(number=number, kind=int(curve.kind), **columns), point))
    variables = cycle_curve_variables(*plane)
    values = _values_along_dimension(variables, "cycle_curve_point", "cycle_curve_", rows)
    values |= {
        "cycle_curve_agreement": traced.max_seed_distance_per_row_length,
        "cycle_curves_untraced": traced.untraced_seed_count,
    }
    return _variables_with_values(variables, values)


def _named_values_and_point(point: Any, names: Sequence[str], **extra_values: Any) -> tuple[Any, ...]:
    """Returns (object, point). The attributes of the object are the parameter values of `point`, under
    `names`, their errors, under `names` + "_error", and `extra_values`."""
    errors = {f"{name}_error": error for name, error in zip(names, point.parameter_errors, strict=True)}
    return SimpleNamespace(
        **dict(zip(names, point.parameter_values, strict=True)), **errors, **extra_values
    ), point


def _values_along_dimension(
    variables: Mapping[str, Variable], dimension: str, prefix: str, rows: Iterable[tuple[Any, ...]]
) -> dict[str, Any]:
    """Lists of values, by name, of those `variables` that have the dimension `dimension` and names beginning
    with `prefix`.

    rows: for each item along the dimension, the objects with the values as attributes, named without the
    prefix.
    """
    variables_of_dimension = [
        variable
        for variable in variables.values()
        if variable.extra_dimensions == (dimension,) and variable.name.startswith(prefix)
    ]
    return value_lists(
        variables_of_dimension, [outcome_values(variables_of_dimension, *row, prefix=prefix) for row in rows]
    )


def _variables_with_values(
    variables: Mapping[str, Variable], values: Mapping[str, Any]
) -> list[FilledVariable]:
    return [(variables[name], np.asarray(value)) for name, value in values.items()]


def _end_reasons(end_reasons: Sequence[int], point_count: int) -> list[dict[str, int]]:
    """Reasons why a curve starts ("start") and ends ("end") at each of its points, as stored integers: 0
    except at the first and the last point.

    end_reasons: (reason at the first point, reason at the last point). point_count: number of points.
    """
    reasons = [{"start": 0, "end": 0} for _ in range(point_count)]
    reasons[0]["start"], reasons[-1]["end"] = end_reasons
    return reasons


def row_cycle_values(result: "CoexistenceRow", line_parameter: str) -> dict[str, Any]:
    """Variables of the cycles of a row: special points, stable states, time and status.

    line_parameter: parameter that varies along the row.
    """
    variables = [
        variable
        for variable in cycle_row_variables(line_parameter)
        if variable.extra_dimensions == (CYCLE_SPECIAL_DIMENSION,)
    ]
    attribute_names = {f"cycle_special_{line_parameter}": "parameter_value"}
    rows = [
        outcome_values(variables, point, prefix="cycle_special_", names=attribute_names)
        for point in result.special_points
    ]
    values: dict[str, Any] = value_lists(variables, rows, MAX_CYCLE_SPECIAL_POINTS)
    values |= {"cycle_special_count": len(result.special_points), "stable_states": result.stable_states}
    values["cycle_followed_from"], values["cycle_followed_to"] = result.followed_range
    return values | {"seconds": result.seconds, "status": int(result.status)}


def unstored_special_point_count(view: ResultView, finite: np.ndarray) -> int:
    """Number of special points that are not stored because the list of their row is full; no curve can start
    at these points. finite: whether the value of the parameter that differs between rows is finite on each
    row, (rows,).
    """
    stored_counts = np.count_nonzero(view.flattened_by_point("cycle_special_kind"), axis=1)
    lacking = view.variables["cycle_special_count"].ravel() - stored_counts
    return int(lacking[finite].clip(min=0).sum())


def with_ends_on_hopf_curves(
    traced: "TracedCurves[SpecialPointCurve]",
    plane: "ParameterPlane",
    criticalities: "Sequence[CurveCriticality]",
    unstored: int,
) -> "TracedCurves[SpecialPointCurve]":
    """The curves in `traced`, with every end at a generalised Hopf point replaced by the point located on the
    Hopf curve. plane: plane of the diagram. criticalities: criticality along each boundary curve. unstored:
    number of special points that are not stored; they count as untraced.
    """
    from ...solve.branch.special.special_curves import with_bautin_ends

    bautin_points = [point for curve in criticalities for point in curve.bautin_points]
    curves = tuple(with_bautin_ends(curve, plane, bautin_points) for curve in traced.curves)
    return replace(traced, curves=curves, untraced_seed_count=traced.untraced_seed_count + unstored)
