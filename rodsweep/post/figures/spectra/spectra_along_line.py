"""Figures of spectra along a line of points: two roots, or all stored roots, against the parameter and in the
complex plane, as in the paper's Fig. 2."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import NullLocator, SymmetricalLogLocator

from ....arrays import Complex
from ....results.file.view import ResultView
from ....sweep.points.points import lines_along
from ...located_thresholds import LocatedThreshold, StoredThresholds
from .. import style
from ..arm.quantities import NO_BREAK_SPACE, set_heading
from .eigenvalues import make_symlog_if_widely_spread

ROOT_CHOICE_TEXTS = {
    "rightmost": "the two rightmost roots",
    "smallest": "of the stored roots, the two smallest in magnitude",
    "all": "all stored roots",
}
"""Description of each choice of roots, by name."""
FOLLOWED_ROOT_COUNT = 2
"""Number of roots that are followed along a line."""
LOGARITHMIC_ROOT_RATIO = 10.0
"""If the ratio of the largest to the median modulus of the roots exceeds this number, the axis of the roots
is logarithmic except near 0."""
THRESHOLD_DIGITS = 6
"""Number of significant digits of a threshold in the legend."""
THRESHOLD_LOOKS = {
    "onset": (rf"${style.TEX_SYMBOLS['F']}_*$", ":"),
    "hopf": (rf"${style.TEX_SYMBOLS['F']}_{{**}}$", "--"),
    "restabilization": ("restabilization", "--"),
}
"""(symbol or word, line style) of each kind of threshold."""
THRESHOLD_LEGEND_ENTRIES = {
    "onset": "onset of oscillation",
    "hopf": "change of stability",
    "restabilization": "change of stability",
}
"""Legend entry of the lines at thresholds, by kind, in figures with several panels, whose titles have the
forces."""
THRESHOLD_LINE_STYLE: dict[str, Any] = {"color": "0.3", "lw": 0.9}
"""Colour and width of lines at thresholds."""
INSTABILITY_SHADE_LOOK: dict[str, Any] = {"color": "0.92", "lw": 0, "zorder": 0}
"""Matplotlib style of the range in which the straight rod is unstable."""


def followed_or_all_roots(growth: np.ndarray, frequency: np.ndarray, roots: str) -> np.ndarray:
    """Two followed roots at each point, complex, (points, 2); all stored roots, (points, modes), if `roots`
    is "all".

    growth, frequency: real and imaginary parts of the stored roots, (points, modes). The first root of a
    complex pair has positive frequency; two real roots are in the order of the choice `roots`.
    """
    w = growth + 1j * frequency
    if roots == "all":
        return w
    if roots == "smallest":
        order = np.lexsort((-frequency, np.round(np.abs(w), 9)), axis=1)
        w = np.take_along_axis(w, order, axis=1)
    return w[:, :2]


def with_gaps_between_roots(x: np.ndarray, w: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Returns (x, w) with NaN inserted between neighbouring points at which the followed roots are not the
    same roots. x: parameter, (n,). w: followed roots, (n, 2)."""
    step = np.abs(np.diff(w, axis=0)).max(axis=1)
    largest_moduli = np.abs(w).max(axis=1)
    # If roots are exchanged, the step is far larger than the neighbouring steps and comparable to the root.
    local_step = np.array([np.median(step[max(0, i - 3) : i + 4]) for i in range(len(step))])
    jump = (
        np.flatnonzero(
            (step > 8 * local_step) & (step > 0.5 * np.minimum(largest_moduli[1:], largest_moduli[:-1]))
        )
        + 1
    )
    return np.insert(x, jump, np.nan), np.insert(w, jump, np.nan, axis=0)


def choice_of_followed_roots(views: Sequence[ResultView], typed_roots: str | None) -> str:
    """Choice of the roots along lines of spectra, one of ROOT_CHOICES: the user's choice `typed_roots`, or
    else "smallest" or "rightmost": if only one of these choices hides no growing root, this choice, otherwise
    the choice with fewer gaps.

    If both choices are equal in this, the smallest roots are followed, as in the paper. If a file stores only
    one root, the choice is "all".
    """
    if any(len(view.variables["mode"]) < FOLLOWED_ROOT_COUNT for view in views):
        return "all"
    if typed_roots:
        return typed_roots

    def breaks(roots: str) -> int:
        lines = (_followed_roots(view, roots) for view in views)
        return sum(len(with_gaps_between_roots(np.arange(len(w), dtype=float), w)[0]) - len(w) for w in lines)

    def hides_growing_root(roots: str) -> bool:
        followed = (_followed_roots(view, roots).real.max(axis=1) for view in views)
        stored = (view.flattened_by_point("growth_rate").max(axis=1) for view in views)
        return any(
            ((followed_roots <= 0) & (stored_roots > 0)).any()
            for followed_roots, stored_roots in zip(followed, stored, strict=True)
        )

    return min(("smallest", "rightmost"), key=lambda roots: (hides_growing_root(roots), breaks(roots)))


def _followed_roots(view: ResultView, roots: str) -> Complex:
    """Roots at the points of a line, the result of `followed_or_all_roots`."""
    return followed_or_all_roots(
        view.flattened_by_point("growth_rate"), view.flattened_by_point("frequency"), roots
    )


def draw_spectra_along_line(view: ResultView, name: str, roots: str) -> Figure:
    """Figure of the roots against the parameter `name`, and in the complex plane."""
    figure = Figure(figsize=(5.2, 6.6), layout="constrained")
    top, bottom = figure.subplots(2, 1)
    w = draw_roots_against_parameter(top, view, name, roots)
    mark_thresholds(top, view, name)
    if roots != "all":
        for i, colour in enumerate((style.BLUE, style.VERMILION)):
            bottom.plot(w[:, i].real, w[:, i].imag, ".-", color=colour, lw=0.8, ms=3)
            _draw_direction_arrow(bottom, w[:, i], colour)
    else:
        x_of_roots = np.broadcast_to(view.parameter_values[name][:, None], w.shape)
        dots = bottom.scatter(w.real.ravel(), w.imag.ravel(), s=6, c=x_of_roots.ravel(), cmap="viridis_r")
        make_symlog_if_widely_spread(bottom, w.real, w.imag)
        figure.colorbar(dots, ax=bottom, label=style.AXIS_LABELS[name])
    bottom.axvline(0, color="0.5", lw=0.6)
    bottom.set(xlabel=r"$\mathrm{Re}\,\omega\,\tau_2$", ylabel=r"$\mathrm{Im}\,\omega\,\tau_2$")
    style.draw_shared_legend(figure, column_count=2)
    set_heading(figure, view, style.constant_parameters_text(view, name), ROOT_CHOICE_TEXTS[roots])
    return figure


def draw_roots_against_parameter(axes: Axes, view: ResultView, name: str, roots: str) -> Complex:
    """Draws roots against the parameter `name`, and returns the roots, with NaN in gaps: followed roots, (n,
    2), or all roots, (n, modes)."""
    x = view.parameter_values[name]
    w = _followed_roots(view, roots)
    if roots != "all":
        x_broken, w = with_gaps_between_roots(x, w)
        # A thin line over a thick line: both are visible where the lines coincide.
        for i, (colour, width) in enumerate(((style.BLUE, 3.0), (style.VERMILION, 1.2))):
            keywords: dict[str, Any] = {"color": colour, "lw": width}
            axes.plot(x_broken, w[:, i].real, label=rf"$\mathrm{{Re}}\,\omega_{i + 1}$", **keywords)
            axes.plot(x_broken, w[:, i].imag, ":", label=rf"$\mathrm{{Im}}\,\omega_{i + 1}$", **keywords)
    else:
        x_of_roots = np.broadcast_to(x[:, None], w.shape)
        for root_part, colour, marker in ((w.real, style.BLUE, "o"), (w.imag, style.VERMILION, "s")):
            word = rf"$\mathrm{{{'Re' if marker == 'o' else 'Im'}}}\,\omega$"
            look: dict[str, Any] = {"color": colour, "mfc": "none", "ms": 2, "mew": 0.6}
            axes.plot(x_of_roots.ravel(), root_part.ravel(), marker, label=word, **look)
    axes.axhline(0, color="0.5", lw=0.6)
    style.scale_axis(axes, "x", x)
    axes.set(xlabel=style.AXIS_LABELS[name], ylabel=r"$\omega\,\tau_2$", xlim=(x[0], x[-1]))
    moduli = np.abs(w[np.isfinite(w)])
    if moduli.max(initial=0.0) > LOGARITHMIC_ROOT_RATIO * np.median(moduli):
        least_tick = 10 ** np.floor(np.log10(np.median(moduli) / 10))
        axes.set_yscale("asinh", linear_width=least_tick / 3)  # asinh is smooth between linear and log
        axes.yaxis.set_major_locator(SymmetricalLogLocator(base=10, linthresh=least_tick))
        axes.yaxis.set_minor_locator(NullLocator())
    return w


def _draw_direction_arrow(axes: Axes, w: Complex, colour: str) -> None:
    """Draws an arrow at the middle of the path w, (n,), of a root, in the direction of the path. If w has
    gaps, the part with the most points is used."""
    unbroken_parts = np.split(w, np.flatnonzero(~np.isfinite(w)))
    path = max((unbroken_part[np.isfinite(unbroken_part)] for unbroken_part in unbroken_parts), key=len)
    ranges = max(float(np.ptp(path.real)), 1e-300), max(float(np.ptp(path.imag)), 1e-300)
    lengths = np.hypot(np.diff(path.real) / ranges[0], np.diff(path.imag) / ranges[1])
    if not lengths.sum() > 0:
        return
    middle_index = int(np.searchsorted(np.cumsum(lengths), lengths.sum() / 2))
    start, end = ((eigenvalue.real, eigenvalue.imag) for eigenvalue in path[middle_index : middle_index + 2])
    arrow = {"arrowstyle": "-|>", "color": colour, "lw": 1.2, "mutation_scale": 14}
    axes.annotate("", xy=end, xytext=start, arrowprops=arrow)


def threshold_symbol_and_force(threshold: LocatedThreshold) -> str:
    """Symbol and force of a threshold, as text."""
    word, _ = THRESHOLD_LOOKS[threshold.kind]
    return f"{word} ={NO_BREAK_SPACE}{threshold.position:#.{THRESHOLD_DIGITS}g}"


def mark_thresholds(
    axes: Axes, view: ResultView, name: str, has_own_legend: bool = True
) -> list[LocatedThreshold]:
    """Shades the range in which the straight rod is unstable. If the parameter `name` is F, also draws lines
    at the located thresholds and returns them; otherwise returns an empty list.

    Thresholds are onsets of oscillation, and forces at which the stability of the straight rod changes.
    has_own_legend: whether this panel has its own legend, whose entries then contain the forces.
    """
    x = view.parameter_values[name]
    unstable = view.variables["unstable_count"].reshape(-1) > 0
    if name != "F":
        if unstable.any():
            transform = axes.get_xaxis_transform()
            axes.fill_between(
                x, 0, 1, where=unstable, transform=transform, label="flutter", **INSTABILITY_SHADE_LOOK
            )
        return []
    (line,) = lines_along(view.point_columns, name)
    located = StoredThresholds(view, name).thresholds_on_line(line)
    thresholds = [threshold for threshold in located if isinstance(threshold, LocatedThreshold)]
    for threshold in thresholds:
        _, dashes = THRESHOLD_LOOKS[threshold.kind]
        label = (
            threshold_symbol_and_force(threshold)
            if has_own_legend
            else THRESHOLD_LEGEND_ENTRIES[threshold.kind]
        )
        axes.axvline(threshold.position, ls=dashes, label=label, **THRESHOLD_LINE_STYLE)
    # The shaded range begins at the upper end of a bracketed Hopf point, and ends at the lower end of a
    # bracketed restabilization.
    starts, ends = list[float](), list[float]()
    for change in located:
        bounds = [change.position] if isinstance(change, LocatedThreshold) else [change.low, change.high]
        if change.kind == "hopf":
            starts.append(bounds[-1])
        elif change.kind == "restabilization":
            ends.append(bounds[0])
    if ends and (not starts or ends[0] < starts[0]):
        starts.insert(0, float(x[0]))
    if len(starts) > len(ends):
        ends.append(float(x[-1]))
    for number, (start, end) in enumerate(zip(starts, ends, strict=True)):
        axes.axvspan(start, end, label=None if number else "flutter", **INSTABILITY_SHADE_LOOK)
    return thresholds
