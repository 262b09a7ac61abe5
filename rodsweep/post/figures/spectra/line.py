"""Spectra along one parameter: two roots and their paths in the complex plane, as the paper's Fig. 2."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ....arrays import Complex
from ....errors import InputError
from ....results.file.view import View
from ...hopf_points import HopfPoint, lines_over
from ...stability_changes import stability_changes
from ..style import FIRST, LABELS, SECOND, SYMBOLS, fixed_text, heading, legend_below, scale

FOLLOWED_ROOTS = {
    "rightmost": "the two rightmost roots",
    "smallest": "of the stored roots, the two smallest in magnitude",
}
LARGE = 10.0
"""Largest root in units of the median one from which on the axis of the roots is logarithmic but near 0."""
THRESHOLD_DIGITS = 6
"""To which thresholds are written beside their marks."""
SHADE: dict[str, Any] = {"color": "0.92", "lw": 0, "zorder": 0}
"""Where the rod is unstable."""


def followed_roots(growth: np.ndarray, frequency: np.ndarray, roots: str) -> np.ndarray:
    """Two roots of each point, complex, shape (points, 2), from all stored ones, shape (points, modes).

    Of a pair the positive frequency is first; two real roots are ordered as `roots` says.
    """
    w = growth + 1j * frequency
    if roots == "smallest":
        order = np.lexsort((-frequency, np.round(np.abs(w), 9)), axis=1)
        w = np.take_along_axis(w, order, axis=1)
    return w[:, :2]


def broken(x: np.ndarray, w: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """(x, w) with a gap of NaN where the followed roots change places with others between two points."""
    step = np.abs(np.diff(w, axis=0)).max(axis=1)
    size = np.abs(w).max(axis=1)
    around = np.array([np.median(step[max(0, i - 3) : i + 4]) for i in range(len(step))])
    jump = np.flatnonzero((step > 8 * around) & (step > 0.5 * np.minimum(size[1:], size[:-1]))) + 1
    return np.insert(x, jump, np.nan), np.insert(w, jump, np.nan, axis=0)


def draw_line(view: View, name: str, roots: str) -> Figure:
    """Two roots over a parameter, and below their paths in the complex plane."""
    figure = Figure(figsize=(5.2, 6.6), layout="constrained")
    top, bottom = figure.subplots(2, 1)
    w = draw_roots(top, view, name, roots)
    mark_flutter(top, view, name)
    for i, colour in enumerate((FIRST, SECOND)):
        bottom.plot(w[:, i].real, w[:, i].imag, ".-", color=colour, lw=0.8, ms=3)
        _point_along(bottom, w[:, i], colour)
    bottom.axvline(0, color="0.5", lw=0.6)
    bottom.set(xlabel=r"$\mathrm{Re}\,\omega\,\tau_2$", ylabel=r"$\mathrm{Im}\,\omega\,\tau_2$")
    legend_below(figure, top.get_legend_handles_labels()[0], 2)
    figure.suptitle(heading(view, fixed_text(view, name), FOLLOWED_ROOTS[roots]), fontsize=9)
    return figure


def draw_roots(axes: Axes, view: View, name: str, roots: str) -> Complex:
    """Draws the two roots that are followed over a parameter; returns them, (n, 2), NaN where they break."""
    x = view.axes[name]
    modes = len(view.variables["mode"])
    if modes < 2:
        raise InputError(
            f"{view.path} holds one mode; the figure follows two, so run with spectrum.modes >= 2"
        )
    growth = view.variables["growth_rate"].reshape(-1, modes)
    w = followed_roots(growth, view.variables["frequency"].reshape(-1, modes), roots)
    x_broken, w = broken(x, w)
    for i, (colour, width) in enumerate(((FIRST, 3.0), (SECOND, 1.2))):  # the thin one on the thick
        look: dict[str, Any] = {"color": colour, "lw": width}
        axes.plot(x_broken, w[:, i].real, label=rf"$\mathrm{{Re}}\,\omega_{i + 1}$", **look)
        axes.plot(x_broken, w[:, i].imag, ":", label=rf"$\mathrm{{Im}}\,\omega_{i + 1}$", **look)
    axes.axhline(0, color="0.5", lw=0.6)
    scale(axes, "x", x)
    axes.set(xlabel=LABELS[name], ylabel=r"$\omega\,\tau_2$", xlim=(x[0], x[-1]))
    sizes = np.abs(w[np.isfinite(w)])
    if sizes.max(initial=0.0) > LARGE * np.median(sizes):
        axes.set_yscale("symlog", linthresh=10 ** np.floor(np.log10(np.median(sizes) / 10)))
    return w


def _point_along(axes: Axes, w: Complex, colour: str) -> None:
    """An arrow half way along a root's path, (n,), the way that it goes along the axis."""
    path = w[np.isfinite(w)]
    ranges = max(np.ptp(path.real), 1e-300), max(np.ptp(path.imag), 1e-300)
    lengths = np.hypot(np.diff(path.real) / ranges[0], np.diff(path.imag) / ranges[1])
    if not lengths.sum() > 0:
        return
    k = int(np.searchsorted(np.cumsum(lengths), lengths.sum() / 2))
    start, end = ((z.real, z.imag) for z in path[k : k + 2])
    arrow = {"arrowstyle": "-|>", "color": colour, "lw": 1.2, "mutation_scale": 14}
    axes.annotate("", xy=end, xytext=start, arrowprops=arrow)


def change_text(change: HopfPoint) -> str:
    """What a change of stability is called, and its force."""
    word = rf"${SYMBOLS['F']}_{{**}}$" if change.destabilises else "restabilization"
    return f"{word} = {change.position:#.{THRESHOLD_DIGITS}g}"


def mark_flutter(axes: Axes, view: View, name: str) -> list[HopfPoint]:
    """Shades where the rod is unstable, over F up to the thresholds, which get a line; returns these."""
    x, unstable = view.axes[name], view.variables["unstable_count"].reshape(-1) > 0
    if name != "F":
        if unstable.any():
            across = axes.get_xaxis_transform()
            axes.fill_between(x, 0, 1, where=unstable, transform=across, label="flutter", **SHADE)
        return []
    (line,) = lines_over(view, name)
    changes = stability_changes(line, view)
    for change in changes:
        axes.axvline(change.position, color="0.3", ls="--", lw=0.9, label=change_text(change))
    starts = [change.position for change in changes if change.destabilises]
    ends = [change.position for change in changes if not change.destabilises]
    if ends and (not starts or ends[0] < starts[0]):
        starts.insert(0, float(x[0]))
    if len(starts) > len(ends):
        ends.append(float(x[-1]))
    for number, (start, end) in enumerate(zip(starts, ends, strict=True)):
        axes.axvspan(start, end, label=None if number else "flutter", **SHADE)
    return changes
