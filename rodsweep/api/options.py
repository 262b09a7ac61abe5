"""The keywords of a rod's tasks, for editors and type checkers: the keys of its options, and the accuracy.

Meanings, ranges and defaults are those of the config, `rodsweep.config`; a test holds these names against it.
"""

from typing import Literal, TypedDict


class OfEveryTask(TypedDict, total=False):
    """What every task can be told."""

    accuracy: float
    title: str
    progress: bool | None
    """Whether a display shows how far a long solve is; by default where a terminal or a notebook is. No key
    of a config."""


class OfSpectrum(OfEveryTask, total=False):
    """Keys of the section `spectrum`."""

    modes: int
    method: Literal["determinant", "krylov_schur"]
    certify: bool
    vectors: bool
    nodes: int
    follow: bool
    longitudinal: bool


class OfThresholds(OfEveryTask, total=False):
    """Keys of the section `thresholds`."""

    F_max: float
    crossings: int
    certify: bool


class OfModes(OfEveryTask, total=False):
    """Keys of the section `modes`."""

    modes: int
    nodes: int
    growth: bool
    certify: bool


class OfCriticality(OfEveryTask, total=False):
    """Keys of the section `criticality`."""

    F_max: float
    crossings: int
    certify: bool


class OfBranch(OfEveryTask, total=False):
    """Keys of the section `branch`."""

    along: str
    start: float
    stop: float
    cycles: int
    special: int
    certify: bool


class OfLimitCycle(OfEveryTask, total=False):
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
