"""Figures of the leading mode of the straight rod, with deformations and adjoint mode, as in the paper's
Figs. 7 to 9."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ...results.file.view import ResultView
from .arm.quantities import set_heading
from .request import FigureRequest
from .style import BLUE, VERMILION, draw_shared_legend, number_in_tex, parameter_text, require_content

MAX_DRAWN_POINTS = 4
"""Largest number of points in one figure; a narrow figure shows one point."""
MODE_PANELS = (
    ("mode", (("Y", r"$Y_1$"), ("Theta", r"$\Theta_1$"))),
    ("deformations", (("h2", r"$h_2$"), ("Pi", r"$\Pi$"))),
    ("adjoint mode", (("adjoint_Y", r"$Y_1^\dagger$"), ("adjoint_Theta", r"$\Theta_1^\dagger$"))),
)
"""(title, ((field, label), (field, label))) of each panel in the row of a point."""


def draw_modes(request: FigureRequest) -> str:
    """Draws a row of panels for each point: leading mode, deformations of this mode, and adjoint mode;
    returns a sentence. Raises InputError for options that the task does not have, and if nothing can be
    drawn."""
    view = request.require_single_view()
    growth = view.variables["growth_rate"][..., 0].ravel()
    point_indices = np.flatnonzero(np.isfinite(growth))
    require_content(view, point_indices.size, "computed point")
    is_narrow = request.look.is_narrow
    drawn_points = point_indices[: 1 if is_narrow else MAX_DRAWN_POINTS]
    point_count = len(drawn_points)
    row_count, column_count = (
        (point_count * len(MODE_PANELS), 1) if is_narrow else (point_count, len(MODE_PANELS))
    )
    figure_size = (4.6, 2.4 * row_count + 0.4) if is_narrow else (10.0, 2.8 * row_count + 0.4)
    figure = Figure(figsize=figure_size, layout="constrained")
    panels = figure.subplots(row_count, column_count, squeeze=False)
    for row, point in zip(panels.reshape(point_count, len(MODE_PANELS)), drawn_points, strict=True):
        for panel, (word, fields) in zip(row, MODE_PANELS, strict=True):
            _draw_mode_fields(panel, view, int(point), fields)
            panel.set_title(word)
        if point_count > 1:
            row[1].set_title(
                f"{': '.join(_parameters_and_eigenvalue_texts(view, int(point)))}\n{MODE_PANELS[1][0]}"
            )
    for panel in panels[-1]:
        panel.set_xlabel("material coordinate $u/L$")
    texts = _parameters_and_eigenvalue_texts(view, int(drawn_points[0])) if point_count == 1 else ()
    set_heading(figure, view, *texts)
    draw_shared_legend(figure, column_count=2)
    omission_clause = ""
    if point_indices.size > point_count:
        first_words = f"first {point_count}" if point_count > 1 else "first"
        omission_clause = f" of the {first_words} of {point_indices.size} points (--at chooses others)"
    return request.write(figure, f"the leading mode{omission_clause}: real part solid, imaginary part dotted")


def _draw_mode_fields(panel: Axes, view: ResultView, point: int, fields: tuple[tuple[str, str], ...]) -> None:
    """Draws two fields of the leading mode at the point with the index `point` against u, with separate
    vertical axes that have 0 at the same height. fields: (field, label) of the two fields."""
    u = view.variables["u"]
    twins = panel, panel.twinx()
    limits = []
    for axes, (name, label), colour in zip(twins, fields, (BLUE, VERMILION), strict=True):
        shape = (-1, *view.variables[f"{name}_real"].shape[-2:])
        real, imag = (view.variables[f"{name}_{part}"].reshape(shape)[point, 0] for part in ("real", "imag"))
        axes.plot(u, real, color=colour, lw=1.5)
        panel.plot([], [], "-", color="0.3", lw=1.5, label="real part")
        if np.abs(imag).max() > 0:
            axes.plot(u, imag, ":", color=colour, lw=1.5)
            panel.plot([], [], ":", color="0.3", lw=1.5, label="imaginary part")
        axes.tick_params(axis="y", colors=colour)
        axes.set_ylabel(label, color=colour)
        limits.append((min(real.min(), imag.min(), 0.0), max(real.max(), imag.max(), 0.0)))
    zero = max(-low / (high - low) if high > low else 0.5 for low, high in limits)
    for axes, (low, high) in zip(twins, limits, strict=True):
        height = max(high / (1 - zero) if zero < 1 else 0.0, -low / zero if zero > 0 else 0.0) or 1.0
        axes.set_ylim(-1.06 * zero * height - 0.02 * height, 1.06 * (1 - zero) * height + 0.02 * height)
    twins[1].spines["right"].set_visible(True)
    panel.axhline(0, color="0.8", lw=0.6, zorder=0)
    panel.set_xlim(0, 1)


def _parameters_and_eigenvalue_texts(view: ResultView, point: int) -> tuple[str, str]:
    """Returns (parameters, leading eigenvalue), as TeX, of the point with the index `point`."""
    parameters = {name: values[point] for name, values in view.point_columns.items()}
    eigenvalue = [float(view.flattened_by_point(name)[point, 0]) for name in ("growth_rate", "frequency")]
    imaginary_text = rf" + {number_in_tex(eigenvalue[1])}\,\mathrm{{i}}" if eigenvalue[1] else ""
    eigenvalue_text = rf"$\omega_1\tau_2 = {number_in_tex(eigenvalue[0])}{imaginary_text}$"
    return parameter_text(parameters, digits=4), eigenvalue_text
