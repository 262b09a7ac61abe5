"""The output of `check` common to all tasks, and the common base of tasks with a certificate."""

from abc import abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from ..model.parameters import PARAMETERS, Parameter
from ..sweep.points.points import Points
from ..wording import counted
from .protocol import Part, Task


@dataclass(frozen=True, slots=True)
class ProvedTask(Task):
    """A task whose completeness can be proved by a certificate."""

    not_proved: ClassVar[str]
    """Consequence of a missing certificate."""
    left_out: ClassVar[tuple[str, str]] = (
        "gravity, inertia, nonlinear motion",
        "not part of the linear overdamped problem",
    )
    """(effects that no option of the task models, reason)."""

    @abstractmethod
    def asked(self) -> list[Part]:
        """Parts that the task's options ask for."""

    @property
    def moved(self) -> dict[str, np.ndarray]:
        """Values of the parameters of the task's rods, each of any shape."""
        return self.points.of_rods | self.coordinates()

    def certificate(self) -> tuple[bool, str]:
        """(whether completeness is proved, the proof or the reason for its absence)."""
        task = self.config.task
        if getattr(self.config, task).certify:
            return True, "winding number of D"
        return False, f"{task}.certify: false; {self.not_proved}"

    def parts(self) -> list[Part]:
        what, why = self.left_out
        return [
            *rod_parts(self.moved),
            *self.asked(),
            ("certificate", *self.certificate()),
            (what, False, why),
        ]


@dataclass(frozen=True, slots=True)
class NonlinearTask(ProvedTask):
    """A task of cycles near Hopf points, or on branches from Hopf points."""

    not_proved: ClassVar[str] = "Hopf points may be missed"
    left_out: ClassVar[tuple[str, str]] = (
        "gravity, inertia, motion out of the plane",
        "not part of the overdamped problem",
    )
    AXIAL: ClassVar[Part] = ("axial drag", True, "parameters.gamma1; it moves no Hopf point, and every cycle")


def count_of(points: Points) -> str:
    """The number of points and the shape of their grid."""
    shape = " x ".join(str(n) for n in points.shape) if points.axes else "a list"
    if points.over:
        shape = f"{shape}: {' x '.join(points.over)}"
    return f"{counted(points.count, 'point')} ({shape})"


def rod_parts(columns: Mapping[str, np.ndarray]) -> list[Part]:
    """Parts of the rod that move for the given values of k1, k2 and gamma3, each of any shape."""
    dragged = bool((columns["gamma3"] > 0).any())
    return [
        *(_deformation(p, columns[p.name]) for p in PARAMETERS.values() if p.rigid),
        ("rotational drag", dragged, "gamma3 > 0" if dragged else "gamma3 = 0"),
    ]


def _deformation(parameter: Parameter, values: np.ndarray) -> Part:
    name, what = parameter.name, parameter.meaning.removesuffix(" stiffness")
    rigid = np.isinf(values)
    if rigid.all():
        return what, False, f"{name} = inf: the rod is {parameter.rigid}"
    return what, True, f"{name} is finite" + (f" at all but {int(rigid.sum())} values" if rigid.any() else "")
