"""Keyword arguments of a rod's tasks, for editors and type checkers.

`rodsweep.config` defines meanings, ranges and defaults; a test compares these names with the config.
"""

from typing import Literal, TypedDict


class TaskKeywords(TypedDict, total=False):
    """Options of every task."""

    accuracy: float
    title: str
    progress: bool | None
    """Whether to display progress; None displays progress only in a terminal or a notebook. No config key."""


class SpectrumKeywords(TaskKeywords, total=False):
    """Keys of the section `spectrum`."""

    modes: int
    method: Literal["determinant", "krylov_schur"]
    certify: bool
    vectors: bool
    nodes: int
    follow: bool
    longitudinal: bool


class ThresholdsKeywords(TaskKeywords, total=False):
    """Keys of the section `thresholds`."""

    F_max: float
    crossings: int
    certify: bool


class ModesKeywords(TaskKeywords, total=False):
    """Keys of the section `modes`."""

    modes: int
    nodes: int
    growth: bool
    certify: bool


class CriticalityKeywords(TaskKeywords, total=False):
    """Keys of the section `criticality`."""

    F_max: float
    crossings: int
    certify: bool


class BranchKeywords(TaskKeywords, total=False):
    """Keys of the section `branch`."""

    along: str
    start: float
    stop: float
    cycles: int
    special: int
    certify: bool


class LimitCycleKeywords(TaskKeywords, total=False):
    """Keys of the section `limit_cycle`."""

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
