"""What `rodsweep show` says of modes: accuracy, stability and non-normality."""

import numpy as np

from ...results.file.view import View
from .ranges import span
from .spectrum import accuracy_lines, eigenvalue_lines, leading_line, stability_line, threshold_lines


def modes_summary(view: View, done: np.ndarray) -> list[str]:
    """The task's lines about the points that are `done`, a mask of the points' shape."""
    v = view.variables
    if done.size == 1:
        lines = [*eigenvalue_lines(view), accuracy_lines(view, done)[-1]]
    else:
        lines = [
            leading_line(view, done),
            *threshold_lines(view),
            *accuracy_lines(view, done),
            stability_line(view, done),
        ]
    errors = v["mode_error"][done]
    if np.isfinite(errors).any():
        lines.append(f"error of the modes, relative: worst {np.nanmax(errors):.1e}")
    lines.append(f"condition of the leading eigenvalue: {span(v['condition'][done][:, 0])}")
    if "transient_growth" in v:
        growth = v["transient_growth"][done]
        lines.append(f"numerical abscissa: {span(v['numerical_abscissa'][done])}")
        if np.isfinite(growth).any():
            time = span(v["transient_time"][done])
            lines.append(f"largest transient growth: {span(growth)} times, at t = {time} tau2")
        if np.isinf(growth).any():
            lines.append(f"growth without bound at {int(np.isinf(growth).sum())} points: a mode is unstable")
    return lines
