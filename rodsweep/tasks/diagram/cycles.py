"""Cycles of the rows of a phase diagram (`phase_diagram.cycles`), and curves of special points."""

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from ...results.file.view import View
from ...results.layouts.phase_diagram import CYCLE_SPECIAL, MAX_CYCLE_SPECIAL, cycle_variables
from ...results.layouts.variables import listed, recorded

if TYPE_CHECKING:
    from ...determinant.parameter_plane import Plane
    from ...solve.branch.coexistence import CoexistenceRow
    from ...solve.branch.special.boundaries import RowSpecial
    from ...solve.branch.special.cycle_curves import CycleCurve
    from ...solve.continuation.boundaries import Boundaries
    from ...solve.hopf.generalised import CurveCriticality


def cycles_record(result: "CoexistenceRow", line: str) -> dict[str, Any]:
    """Cycles of a row as variables of the file, including time and status of the row; line: the row's
    parameter.
    """
    variables = [v for v in cycle_variables(line) if v.extra == (CYCLE_SPECIAL,)]
    own = {f"cycle_special_{line}": "at", "cycle_special_tip_y_max_error": "size_error"}
    rows = [recorded(variables, point, prefix="cycle_special_", names=own) for point in result.special]
    values: dict[str, Any] = listed(variables, rows, MAX_CYCLE_SPECIAL)
    values |= {"cycle_special_count": len(result.special), "stable_states": result.stable_states}
    return values | {"seconds": result.seconds, "status": int(result.status)}


def row_specials(view: View, line: str, rows: np.ndarray) -> "list[RowSpecial]":
    """Folds and torus points of all finite rows in the file. rows: value of every row, (rows,)."""
    from ...solve.branch.special.boundaries import FOLLOWED_KINDS, RowSpecial
    from ...solve.branch.special.point import SpecialKind

    names = (f"cycle_special_{name}" for name in ("kind", line, "period", "tip_y_max"))
    kinds, at, period, height = map(view.by_point, names)
    return [
        RowSpecial(
            number=int(i),
            row=float(rows[i]),
            kind=SpecialKind(int(kinds[i, j])),
            at=float(at[i, j]),
            period=float(period[i, j]),
            tip_y_max=float(height[i, j]),
        )
        for i in np.flatnonzero(np.isfinite(rows))
        for j in np.flatnonzero(np.isin(kinds[i], tuple(FOLLOWED_KINDS)))
    ]


def unstored_specials(view: View, finite: np.ndarray) -> int:
    """Number of special points missing from the full lists of finite rows; no curve starts there. finite:
    (rows,).
    """
    stored = np.count_nonzero(view.by_point("cycle_special_kind"), axis=1)
    lacking = view.variables["cycle_special_count"].ravel() - stored
    return int(lacking[finite].clip(min=0).sum())


def with_hopf_ends(
    found: "Boundaries[CycleCurve]",
    plane: "Plane",
    criticalities: "Sequence[CurveCriticality]",
    unstored: int,
) -> "Boundaries[CycleCurve]":
    """Curves whose ends at generalised Hopf points are replaced by the points located on Hopf curves."""
    from ...solve.branch.special.cycle_curves import ending_at

    known = [point for curve in criticalities for point in curve.points]
    curves = tuple(ending_at(curve, plane, known) for curve in found.curves)
    return replace(found, curves=curves, untraced=found.untraced + unstored)
