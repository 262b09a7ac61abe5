"""Figures of eigenvalues without lines between points: one point in the complex plane, or a list of
points."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ....results.file.view import ResultView
from ..arm.quantities import set_heading
from ..point_lists import label_point_numbers, shared_parameters
from ..style import BLUE, VERMILION, draw_shared_legend, parameter_text, require_content

MIN_MODULUS_RATIO_FOR_SYMLOG = 100.0
"""An axis is symmetric logarithmic if the ratio of the largest to the smallest nonzero modulus exceeds
this number."""
LINEAR_RANGE_FRACTION = 1e-6
"""A symmetric logarithmic axis is linear up to this fraction of the largest modulus, or up to the quantile
LINEAR_RANGE_QUANTILE if this is larger. The limit is rounded down to a power of ten."""
LINEAR_RANGE_QUANTILE = 0.1
"""Quantile of the moduli for the linear range of a symmetric logarithmic axis."""
MODE_LOOKS = {True: (VERMILION, "s", "growing mode"), False: (BLUE, "o", "decaying mode")}
"""(colour, marker, legend entry) of growing modes (True) and decaying modes (False)."""
MAX_NUMBERED_MODES = 8
"""The first modes, up to this number, are labelled with their numbers."""


def draw_eigenvalues(view: ResultView) -> Figure:
    """Figure of the stored eigenvalues of the only point in a file, in the complex plane, with the numbers of
    the modes. Raises InputError if nothing can be drawn."""
    mode_count = len(view.variables["mode"])
    growth, frequency = (view.variables[name].reshape(mode_count) for name in ("growth_rate", "frequency"))
    require_content(view, np.isfinite(growth).any(), "computed point")
    figure = Figure(figsize=(5.2, 4.0), layout="constrained")
    axes = figure.subplots()
    _draw_markers(axes, growth, frequency, growth > 0)
    make_symlog_if_widely_spread(axes, growth, frequency)
    for mode in range(min(mode_count, MAX_NUMBERED_MODES)):
        if np.isfinite(growth[mode]):
            eigenvalue = growth[mode], frequency[mode]
            axes.annotate(str(mode + 1), eigenvalue, (5, 5), textcoords="offset points", size=8)
    axes.axvline(0, color="0.5", lw=0.6)
    axes.axhline(0, color="0.8", lw=0.6, zorder=0)
    axes.margins(0.12)
    axes.set(xlabel=r"$\mathrm{Re}\,\omega\,\tau_2$", ylabel=r"$\mathrm{Im}\,\omega\,\tau_2$")
    draw_shared_legend(figure, column_count=2)
    set_heading(figure, view, parameter_text(shared_parameters(view)))
    return figure


def draw_list_of_spectra(view: ResultView) -> Figure:
    """Figure of the growth rates and frequencies of a list of points against the number of the point."""
    growth = view.variables["growth_rate"]
    frequency = view.variables["frequency"]
    figure = Figure(figsize=(5.2, 5.4), layout="constrained")
    panels = figure.subplots(2, 1, sharex=True)
    number = np.broadcast_to(np.arange(1, len(growth) + 1)[:, None], growth.shape)
    for axes, values, part_name in zip(panels, (growth, frequency), ("Re", "Im"), strict=True):
        _draw_markers(axes, number, values, growth > 0)
        make_symlog_if_widely_spread(axes, None, values)
        axes.axhline(0, color="0.5", lw=0.6, zorder=0)
        axes.set_ylabel(rf"$\mathrm{{{part_name}}}\,\omega\,\tau_2$")
    label_point_numbers(panels[1], view, len(growth))
    draw_shared_legend(figure, column_count=2)
    set_heading(figure, view, parameter_text(shared_parameters(view)))
    return figure


def _draw_markers(axes: Axes, x: np.ndarray, y: np.ndarray, is_growing: np.ndarray) -> None:
    """Draws markers of decaying and growing modes at the points (x, y). x, y: arrays of equal shape.
    is_growing: mask of growing modes, of the same shape."""
    for kind, (colour, marker, label) in MODE_LOOKS.items():
        is_drawn = (is_growing == kind) & np.isfinite(y)
        if is_drawn.any():
            axes.plot(x[is_drawn], y[is_drawn], marker, color=colour, mfc="none", ms=4.5, label=label)


def make_symlog_if_widely_spread(axes: Axes, x: np.ndarray | None, y: np.ndarray) -> None:
    """Makes each axis symmetric logarithmic if the ratio of its largest to smallest nonzero modulus is above
    MIN_MODULUS_RATIO_FOR_SYMLOG. x, y: values on the axes, of any shape; None for an axis that stays
    unchanged."""
    for set_scale, values in ((axes.set_xscale, x), (axes.set_yscale, y)):
        moduli = np.abs(values[np.isfinite(values) & (values != 0)]) if values is not None else np.zeros(0)
        if moduli.size and moduli.max() > MIN_MODULUS_RATIO_FOR_SYMLOG * moduli.min():
            smallest = max(
                float(np.quantile(moduli, LINEAR_RANGE_QUANTILE)), moduli.max() * LINEAR_RANGE_FRACTION
            )
            set_scale("symlog", linthresh=10 ** np.floor(np.log10(smallest)))
