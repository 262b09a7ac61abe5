"""What `check` says in the same words of every rod, and what the tasks of the linear problem share."""

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
    """A task that may be proved complete; what it asks for stands between what rods can do and what not."""

    not_proved: ClassVar[str]
    """What may happen without a certificate."""
    left_out: ClassVar[tuple[str, str]] = (
        "gravity, inertia, nonlinear motion",
        "not part of the linear overdamped problem",
    )
    """What no option of the task models, and why."""

    @abstractmethod
    def asked(self) -> list[Part]:
        """What the task's options ask for."""

    @property
    def moved(self) -> dict[str, np.ndarray]:
        """The values of the parameters that the task's rods have, each of any shape."""
        return self.points.of_rods | self.coordinates()

    def certificate(self) -> tuple[bool, str]:
        """Whether completeness is proved, and by what, or why not."""
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
    """A task of cycles next to or on branches, which Hopf points of the straight rod begin."""

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
    """Which of the rod's parts the values of k1, k2 and gamma3 make move, each of any shape."""
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
