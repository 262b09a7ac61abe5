"""What `check` says in the same words for several tasks."""

from collections.abc import Mapping

import numpy as np

from ...sweep.grid import Points
from .protocol import Part

LEFT_OUT: Part = (
    "gravity, inertia, nonlinear motion",
    False,
    "not part of the linear overdamped problem",
)


def count_of(points: Points) -> str:
    """The number of points and the shape of their grid."""
    shape = " x ".join(str(n) for n in points.shape) if points.is_grid else "a list"
    return f"{points.count} points ({shape})"


def rod_parts(columns: Mapping[str, np.ndarray]) -> list[Part]:
    """Which of the rod's parts the values of k1, k2 and gamma3 make move."""
    dragged = bool((columns["gamma3"] > 0).any())
    return [
        _compliance("stretch", "k1", columns["k1"], "inextensible"),
        _compliance("shear", "k2", columns["k2"], "unshearable"),
        ("rotational drag", dragged, "gamma3 > 0" if dragged else "gamma3 = 0"),
    ]


def certificate_part(task: str, certify: bool, missed: str) -> Part:
    """Whether the winding number proves that nothing is missed."""
    return ("certificate", certify, "winding number of D" if certify else f"{task}.certify: false; {missed}")


def _compliance(part: str, name: str, values: np.ndarray, word: str) -> Part:
    rigid = np.isinf(values)
    if rigid.all():
        return part, False, f"{name} = inf: the rod is {word}"
    return part, True, f"{name} is finite" + (f" at all but {int(rigid.sum())} values" if rigid.any() else "")
