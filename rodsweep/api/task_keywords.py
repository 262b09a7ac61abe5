"""Keyword arguments of the task methods of `rs.Rod` and `rs.Arm`, for editors and type checkers.

`rodsweep.config` defines the meaning, the range and the default of each keyword.
"""

from typing import Literal, TypedDict


class TaskKeywords(TypedDict, total=False):
    """Keyword arguments that every task accepts."""

    accuracy: float
    """Relative error of the results of the task; the default depends on the task."""
    title: str
    """Name of the run, printed by `check` and `show`."""
    progress: bool | None
    """Whether to display progress; None: only in a terminal or a notebook. Not a key of a config."""


class SpectrumKeywords(TaskKeywords, total=False):
    """Keyword arguments of the task spectrum: the keys of the section `spectrum` of a config."""

    modes: int
    """Number of leading eigenvalues."""
    method: Literal["determinant", "krylov_schur"]
    """Roots of the characteristic determinant D, or Krylov-Schur on two meshes without certificate."""
    certify: bool
    """Whether to prove by the winding number of D that no eigenvalue is missing."""
    vectors: bool
    """Whether to store the eigenvectors (Y, Theta), scaled to Y(1) = 1."""
    nodes: int
    """Number of Lobatto nodes at which each mode is returned."""
    follow: bool
    """Whether to follow eigenvalues along the longest axis of a grid."""
    longitudinal: bool
    """Whether to add the growth rates of the longitudinal modes."""


class ThresholdsKeywords(TaskKeywords, total=False):
    """Keyword arguments of the task thresholds: the keys of the section `thresholds` of a config."""

    F_max: float
    """Largest force of the search, in k3/L^2."""
    crossings: int
    """Maximum number of stored thresholds."""
    certify: bool
    """Whether to confirm by winding numbers that no threshold is missing."""


class ModesKeywords(TaskKeywords, total=False):
    """Keyword arguments of the task modes: the keys of the section `modes` of a config."""

    modes: int
    nodes: int
    """Number of Lobatto nodes at which each mode is returned."""
    growth: bool
    """Whether to compute the numerical abscissa and the transient growth."""
    certify: bool
    """Whether to prove by the winding number of D that no leading mode is missing."""


class CriticalityKeywords(TaskKeywords, total=False):
    """Keyword arguments of the task criticality: the keys of the section `criticality` of a config."""

    F_max: float
    """Largest force of the search for Hopf points, in k3/L^2."""
    crossings: int
    """Maximum number of stored Hopf points."""
    certify: bool
    """Whether to confirm by winding numbers that no Hopf point is missing."""


class BranchKeywords(TaskKeywords, total=False):
    """Keyword arguments of the task branch: the keys of the section `branch` of a config."""

    along: str
    """Parameter along which the branches are followed."""
    start: float
    """Smallest value of the parameter `along`; a branch that reaches this value ends."""
    stop: float
    """Largest value of the parameter `along`; a branch that reaches this value ends."""
    cycles: int
    """Maximum number of stored cycles per rod, over all branches."""
    special: int
    """Maximum number of stored special points per rod."""
    work: float | None
    """Largest work on the branches of a rod, in 1e9 multiplications of matrix elements; None for no limit."""
    certify: bool
    """Whether to confirm by winding numbers that no Hopf point is missing."""


class LimitCycleKeywords(TaskKeywords, total=False):
    """Keyword arguments of the task limit_cycle: the keys of the section `limit_cycle` of a config."""

    method: Literal["collocation", "integration"]
    """Collocation in time, with Floquet multipliers, or time integration only, without them."""
    amplitude: float
    """Tip deflection, in L, of the initial guess with the shape of the leading mode."""
    start: Literal["mode", "neighbour", "hopf"]
    """Initial guess: the leading mode, the cycle of a neighbouring point, or the cycle near the Hopf
    point."""
    along: str
    """Parameter along which the cycle of a point is the initial guess at the next point."""
    direction: Literal["up", "down"]
    """Whether the parameter `along` increases or decreases from a point to the next."""
    harmonics: int
    """Number of stored harmonics of the tip's y."""
    samples: int
    """Number of times per period at which the tip and the energy are stored; 0 stores none."""
    shapes: int
    """Number of times per period at which the shape of the rod is stored; 0 stores none."""
    nodes: int
    """Number of Lobatto nodes of each shape."""
    transient: int
    """Number of times, from the start of the motion until the cycle is reached, at which the tip is stored; 0
    stores none."""
    most_periods: int
    """Maximum number of periods of the motion, counted as returns of the tip to theta = 0."""
    time: Literal["tau2", "tau1"]
    """Unit of time; "tau1" adds the period in tau1, all other variables stay in tau2."""


KEYWORDS_OF_TASK = {
    "spectrum": SpectrumKeywords,
    "modes": ModesKeywords,
    "thresholds": ThresholdsKeywords,
    "criticality": CriticalityKeywords,
    "limit_cycle": LimitCycleKeywords,
    "branch": BranchKeywords,
}
"""Keyword arguments of the methods of an arm and of a rod, by name of the method."""
