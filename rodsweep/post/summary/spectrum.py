"""What `rodsweep show` says of spectra: accuracy, cost and stability."""

import numpy as np

from ...results.file.view import View


def spectrum_summary(view: View, done: np.ndarray) -> list[str]:
    """The task's lines about the points that are `done`, a mask of the points' shape."""
    return [*accuracy_lines(view, done), stability_line(view, done)]


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
    return [*lines, f"unknowns a point: {unknowns.min()} to {unknowns.max()}"]


def stability_line(view: View, done: np.ndarray) -> str:
    """How many points are certified, and how many unstable; `done` has the points' shape."""
    unstable = view.variables["unstable_count"][done]
    return (
        f"certified: {int(view.variables['certified'][done].sum())} of {int(done.sum())}; unstable modes: at "
        f"most {max(int(unstable.max()), 0)}, at {int((unstable > 0).sum())} points; not known at "
        f"{int((unstable < 0).sum())}"
    )
