"""Hopf curves of a phase diagram with styles by criticality, and generalised Hopf points."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D

from ....model.parameters import NON_OPTIONAL_LINEAR_PARAMETERS
from ....results.file.view import ResultView
from ...plane_curves import PlaneParameters
from ..style import TEX_SYMBOLS
from ..style import number_in_tex as number_text

CRITICALITY_LOOKS = {
    -1: ("supercritical Hopf points", 1.4, "-"),
    1: ("subcritical Hopf points", 1.4, "--"),
    0: ("Hopf points, criticality undecided", 0.6, "-"),
}
"""(legend entry, width, style) of parts of a Hopf curve, by sign of Re c."""


def draw_hopf_curves_by_criticality(
    axes: Axes, view: ResultView, parameters: PlaneParameters
) -> list[Line2D]:
    """Draws Hopf curves with line styles by criticality, and generalised Hopf points; returns legend
    entries."""
    variables = view.variables
    drawn_criticalities = set()
    for curve in np.unique(variables["curve_number"][variables["curve_kind"] == 1]):
        for criticality, points in parts_of_equal_criticality(view, int(curve), parameters):
            _, width, style = CRITICALITY_LOOKS[criticality]
            axes.plot(*points.T, style, color="k", lw=width)
            drawn_criticalities.add(criticality)
    handles = [
        Line2D([], [], color="k", lw=width, ls=style, label=word)
        for criticality, (word, width, style) in CRITICALITY_LOOKS.items()
        if criticality in drawn_criticalities
    ]
    for i in range(len(variables["bautin_curve"])):
        x, y = (variables[f"bautin_{name}"][i] for name in parameters)
        symbols = [TEX_SYMBOLS[name] for name in parameters]
        label = rf"generalised Hopf point: ${symbols[0]}$ = {x:.6g}, ${symbols[1]}$ = {y:.6g}"
        handles += axes.plot(x, y, "kD", mfc="white", ls="", ms=5, label=label)
    if "bautin_along_curve" in variables:
        handles += _draw_bautin_curves(axes, view, parameters)
    return handles


def _draw_bautin_curves(axes: Axes, view: ResultView, parameters: PlaneParameters) -> list[Line2D]:
    """Draws curves of generalised Hopf points; returns legend entries."""
    variables = view.variables
    curves = []
    third = next(
        parameter_name
        for parameter_name in NON_OPTIONAL_LINEAR_PARAMETERS
        if f"bautin_along_{parameter_name}" in variables and parameter_name not in parameters
    )
    for number in np.unique(variables["bautin_along_curve"]):
        mask = variables["bautin_along_curve"] == number
        third_values = variables[f"bautin_along_{third}"][mask]
        lowest_text, highest_text = (
            number_text(float(end), 3) for end in (third_values.min(), third_values.max())
        )
        label = rf"generalised Hopf points, ${TEX_SYMBOLS[third]}$ = ${lowest_text}$ to ${highest_text}$"
        x, y = (variables[f"bautin_along_{name}"][mask] for name in parameters)
        curves += axes.plot(x, y, "-.", color="tab:red", lw=1.2, label=label)
    return curves


def parts_of_equal_criticality(
    view: ResultView, curve: int, parameters: PlaneParameters
) -> list[tuple[int, np.ndarray]]:
    """(sign of Re c, points, (n, 2)) of parts of a Hopf curve between generalised Hopf points."""
    variables = view.variables
    indices = np.flatnonzero(variables["curve_number"] == curve)
    bautin = np.flatnonzero(variables["bautin_curve"] == curve)
    places = np.searchsorted(indices, variables["bautin_curve_point"][bautin] - 1, side="right")
    names = ((f"curve_{name}", f"bautin_{name}") for name in parameters)
    points = np.column_stack(
        [
            np.insert(variables[curve_name][indices], places, variables[bautin_name][bautin])
            for curve_name, bautin_name in names
        ]
    )
    criticality = np.insert(np.nan_to_num(variables["curve_criticality"][indices]), places, 0)
    # A segment has the sign of its ends; if the sign at one end is undecided, the sign of the other end.
    ends = criticality[:-1], criticality[1:]
    signs = np.where(ends[0] * ends[1] < 0, 0, np.sign(ends[0] + ends[1])).astype(int)
    cuts = [0, *(np.flatnonzero(np.diff(signs)) + 1), len(signs)]
    return [
        (int(signs[curve_name]), points[curve_name : bautin_name + 1])
        for curve_name, bautin_name in zip(cuts[:-1], cuts[1:], strict=True)
        if bautin_name > curve_name
    ]
