"""Dimensions of result files, with the units and long names of their coordinates."""

from typing import Any

from ...model.parameters import PARAMETERS

UNIT_AND_LONG_NAME_OF_DIMENSION = {p.name: (p.unit, p.long_name) for p in PARAMETERS.values()} | {
    "point": ("1", "row of the point list, from 1"),
    "mode": ("1", "number of the eigenvalue, by descending growth rate; in a pair, positive frequency first"),
    "u": ("1", "material coordinate along the rod"),
    "crossing": ("1", "number of the crossing, by increasing value of the varied parameter"),
    "curve_point": ("1", "number of the point on all boundary curves, curve by curve"),
    "fold": ("1", "number of the fold, at which a boundary curve turns back"),
    "branch_point": ("1", "number of the cycle on all branches of a rod, branch by branch"),
    "special": ("1", "number of the special point on all branches of a rod, branch by branch"),
    "cycle_special": ("1", "number of the special point on all branches of cycles of a row"),
    "cycle_curve_point": ("1", "number of the point on all curves of folds and torus points, curve by curve"),
    "cycle_extremum": ("1", "number of the extremum of the row parameter along a curve of folds of cycles"),
    "cycle_detached": ("1", "number of the row among the rows with detached branches of cycles"),
    "bautin": ("1", "number of the generalised Hopf point, Hopf curve by Hopf curve"),
    "bautin_step": ("1", "number of the point on curves of generalised Hopf points, curve by curve"),
    "change": ("1", "number of the change located between neighbouring points along F, line by line"),
    "hopf": ("1", "number of the Hopf point located between neighbouring points, line by line"),
    "harmonic": ("1", "multiple of the cycle's frequency"),
    "multiplier_number": ("1", "number of the nontrivial Floquet multiplier, by descending modulus"),
    "sample": ("1", "time in periods, from the instant at which y of the tip rises through its mean"),
    "shape": ("1", "time in periods, from the instant at which y of the tip rises through its mean"),
    "transient": ("1", "time since the start, in units of the last stored time of the motion"),
}
"""(unit, long name) of the coordinate of every dimension, by name."""


def dimension_attributes(name: str) -> dict[str, Any]:
    """Attributes of the coordinate of the dimension `name`: unit and long name."""
    return dict(zip(("units", "long_name"), UNIT_AND_LONG_NAME_OF_DIMENSION[name], strict=True))
