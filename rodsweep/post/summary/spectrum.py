"""What `rodsweep show` says of spectra: accuracy, cost and stability."""

import numpy as np

from ...results.file.view import View
from ..stability_changes import thresholds_on
from .ranges import span, to_error
from .stability import stability_lines

HOW_FOUND = (
    "zeros of the characteristic determinant D(i eta; F), and double ones for F*, where the leading "
    "eigenvalue changes so between two forces of the file; `task: thresholds` proves that none is missing"
)
"""What the forces are that `threshold_lines` tells."""
PROOFS = {True: "proved by a winding number", False: "not proved"}
"""What is said of the number of unstable modes at a single point."""


def spectrum_summary(view: View, done: np.ndarray) -> list[str]:
    """The task's lines about the points that are `done`, a mask of the points' shape."""
    if done.size == 1:
        return [*eigenvalue_lines(view), accuracy_lines(view, done)[-1]]
    lines = [leading_line(view, done), *threshold_lines(view)]
    return [*lines, *accuracy_lines(view, done), stability_line(view, done)]


def leading_line(view: View, done: np.ndarray) -> str:
    """How the straight rod fares over the points that are `done`, a mask of their shape."""
    v = view.variables
    unstable = v["unstable_count"][done]
    counts = {
        "stable": (unstable == 0).sum(),
        "unstable": (unstable > 0).sum(),
        "not known": (unstable < 0).sum(),
    }
    told = ", ".join(f"{word} at {int(count)}" for word, count in counts.items() if count)
    rate, frequency = (span(v[name][done][:, 0]) for name in ("growth_rate", "frequency"))
    return (
        f"straight rod: {told} of {unstable.size} points; leading growth rate {rate}, frequency {frequency} "
        "1/tau2"
    )


def threshold_lines(view: View) -> list[str]:
    """The forces from which the rod oscillates, is unstable or stable; none where F is no axis."""
    lines = stability_lines(view, thresholds_on)
    return [*lines, f"  ({HOW_FOUND})"] if lines else []


def eigenvalue_lines(view: View) -> list[str]:
    """The eigenvalues of the one point of a file, with their errors, and how many of them are unstable."""
    v = view.variables
    columns = (v[name].ravel() for name in ("growth_rate", "frequency", "error_estimate"))
    lines = [
        f"mode {number}: growth rate {to_error(growth, error)}, frequency {to_error(frequency, error)} 1/tau2"
        for number, (growth, frequency, error) in enumerate(zip(*columns, strict=True), 1)
        if np.isfinite(growth)
    ]
    unstable, proof = int(v["unstable_count"].max()), PROOFS[bool(v["certified"].all())]
    count = f"unstable modes: {unstable}, {proof}" if unstable >= 0 else "unstable modes: not known"
    return [*lines, count]


def accuracy_lines(view: View, done: np.ndarray) -> list[str]:
    """How accurate the eigenvalues are, and on how many unknowns; `done` has the points' shape."""
    v = view.variables
    lines = []
    size = np.hypot(v["growth_rate"][done], v["frequency"][done])
    relative = v["error_estimate"][done] / size
    if np.isfinite(relative).any():
        lines.append(
            f"error estimate, relative: worst {np.nanmax(relative):.1e}, median {np.nanmedian(relative):.1e}"
        )
    unknowns = 3 * v["elements"][done].astype(int) * v["order"][done]
    if (followed := int((unknowns == 0).sum())) == unknowns.size:
        return [*lines, "unknowns a point: none, all followed from neighbours or failed"]
    meshes = unknowns[unknowns > 0]
    without = f"; none at {followed} that were followed or failed" if followed else ""
    return [*lines, f"unknowns a point: {meshes.min()} to {meshes.max()}{without}"]


def stability_line(view: View, done: np.ndarray) -> str:
    """How many points are certified, and how many unstable; `done` has the points' shape."""
    unstable = view.variables["unstable_count"][done]
    return (
        f"certified: {int(view.variables['certified'][done].sum())} of {int(done.sum())}; unstable modes: at "
        f"most {max(int(unstable.max()), 0)}, at {int((unstable > 0).sum())} points; not known at "
        f"{int((unstable < 0).sum())}"
    )
