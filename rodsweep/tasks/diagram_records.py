"""Curves of a phase diagram as variables of its file: boundaries, criticality, generalised Hopf points."""

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from ..solve.changes.boundary_curves import BoundaryCurve
    from ..solve.continuation.boundaries import Boundaries
    from ..solve.hopf.bautin_curves import BautinCurve
    from ..solve.hopf.generalised import CurveCriticality


def curve_record(found: "Boundaries[BoundaryCurve]", line: str, row: str) -> dict[str, Any]:
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
        "bautin_curve_point": [start + point.after + 1 for _, start, point in found],
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
