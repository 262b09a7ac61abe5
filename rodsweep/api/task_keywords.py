"""Keyword arguments of the task methods of `rs.Rod` and `rs.Arm`, for editors and type checkers.

`rodsweep.config` defines the meaning, the range and the default of each keyword.
"""

from typing import Literal, TypedDict


class TaskKeywords(TypedDict, total=False):
    """Keyword arguments that every task accepts."""

    accuracy: float
    title: str
    progress: bool | None
    """Whether to display progress; None: only in a terminal or a notebook. No key of a config."""


class SpectrumKeywords(TaskKeywords, total=False):
    """Keyword arguments of the task spectrum: the keys of the section `spectrum` of a config."""

    modes: int
    method: Literal["determinant", "krylov_schur"]
    certify: bool
    vectors: bool
    nodes: int
    """Number of Lobatto nodes at which each mode is returned."""
    follow: bool
    longitudinal: bool


class ThresholdsKeywords(TaskKeywords, total=False):
    """Keyword arguments of the task thresholds: the keys of the section `thresholds` of a config."""

    F_max: float
    crossings: int
    certify: bool


class ModesKeywords(TaskKeywords, total=False):
    """Keyword arguments of the task modes: the keys of the section `modes` of a config."""

    modes: int
    nodes: int
    """Number of Lobatto nodes at which each mode is returned."""
    growth: bool
    certify: bool


class CriticalityKeywords(TaskKeywords, total=False):
    """Keyword arguments of the task criticality: the keys of the section `criticality` of a config."""

    F_max: float
    crossings: int
    certify: bool


class BranchKeywords(TaskKeywords, total=False):
    """Keyword arguments of the task branch: the keys of the section `branch` of a config."""

    along: str
    start: float
    stop: float
    cycles: int
    special: int
    work: float | None
    certify: bool


class LimitCycleKeywords(TaskKeywords, total=False):
    """Keyword arguments of the task limit_cycle: the keys of the section `limit_cycle` of a config."""

    method: Literal["collocation", "integration"]
    amplitude: float
    start: Literal["mode", "neighbour", "hopf"]
    along: str
    direction: Literal["up", "down"]
    harmonics: int
    samples: int
    shapes: int
    nodes: int
    transient: int
    most_periods: int
    time: Literal["tau2", "tau1"]


KEYWORDS_OF_TASK = {
    "spectrum": SpectrumKeywords,
    "modes": ModesKeywords,
    "thresholds": ThresholdsKeywords,
    "criticality": CriticalityKeywords,
    "limit_cycle": LimitCycleKeywords,
    "branch": BranchKeywords,
}
"""Keyword arguments of the methods of an arm and of a rod, by name of the method."""
