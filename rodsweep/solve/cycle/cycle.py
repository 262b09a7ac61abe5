"""A point of the task limit_cycle: its request, and its outcome."""

from dataclasses import dataclass, replace
from math import nan
from typing import Any

import numpy as np

from ...arrays import Array, Complex
from ..orbit.measures import CyclePath, Measures
from ..status import PointStatus
from .accuracy.cycle_errors import UNKNOWN_ERRORS, CycleErrors
from .neighbour import Neighbour
from .second_state import SecondState


@dataclass(frozen=True, slots=True)
class CycleRequest:
    """What is asked of every rod.

    accuracy: relative, of period and extrema. amplitude: the tip's y of the start, in L. start: "mode" for
    the leading mode, "neighbour" for it where there is no neighbour, "hopf" for the Hopf point. harmonics:
    how many. samples: of the tip and of the energy over a period; shapes, nodes: shapes over a period and
    Lobatto nodes of each; 0 for none. most_periods: returns of the tip to wait for. transient: times of the
    tip's path from the start; 0 for none. A path that is wanted has no jumps, and is followed where its end
    is known without it.
    """

    accuracy: float
    amplitude: float
    harmonics: int
    samples: int
    shapes: int
    nodes: int
    most_periods: int
    start: str = "mode"
    transient: int = 0


@dataclass(frozen=True, kw_only=True)
class Cycle:
    """What became of one rod, and the numbers of its cycle: NaN or None where there is none.

    linear_growth_rate and linear_frequency of the leading mode about the straight rod, 1/tau2; periods:
    returns waited for. second_state: a SecondState, subcritical_F: the force of the Hopf point that makes a
    cycle possible. multiplier: the largest nontrivial Floquet multiplier's modulus; multipliers: the
    largest ones, complex, (STORED_MULTIPLIERS,); trivial_multiplier_error: distance of the trivial one from
    1. On a torus these are all that is known, and those of the unstable cycle that it surrounds.

    tip: x, y, theta at equidistant times, (3, samples); energy: U in k3/L, injection, dissipation, (3,
    samples); shape: x, y, theta, (3, shapes, nodes). Time starts where the tip's y rises through its mean.
    transient: time in tau2, x, y, theta of the tip from the start to where the motion was left, (4,
    transient); None where no motion was followed.
    neighbour: what the next point of a chain starts from.
    """

    status: PointStatus
    message: str = ""
    seconds: float = 0.0
    linear_growth_rate: float = nan
    linear_frequency: float = nan
    periods: int = 0
    second_state: int = SecondState.not_told
    subcritical_F: float = nan
    elements: int = 0
    order: int = 0
    measures: Measures = Measures()
    errors: CycleErrors = UNKNOWN_ERRORS
    multiplier: float = nan
    multipliers: Complex | None = None
    trivial_multiplier_error: float = nan
    tip: Array | None = None
    energy: Array | None = None
    shape: Array | None = None
    transient: Array | None = None
    neighbour: Neighbour | None = None


def measured(
    cycle: Cycle, request: CycleRequest, path: CyclePath, measures: Measures, errors: CycleErrors
) -> Cycle:
    """The outcome with the numbers of a cycle, and what is stored of its path where it is asked for."""
    mesh = path.orbit.form.mesh
    # Harmonics that are not resolved are below the error of the cycle.
    amplitudes = first_of(measures.harmonic_amplitude, request.harmonics, 0.0)
    return replace(
        cycle,
        elements=mesh.elements,
        order=mesh.order,
        measures=replace(measures, harmonic_amplitude=amplitudes),
        errors=errors,
        tip=path.tip(request.samples) if request.samples else None,
        energy=path.energy(request.samples) if request.samples else None,
        shape=path.shapes(request.shapes, request.nodes) if request.shapes else None,
    )


def first_of(values: Array | Complex, count: int, other: complex) -> Any:
    """So many of the values, (m,), and another one where there are none, (count,)."""
    first = np.full(count, other, values.dtype)
    first[: len(values)] = values[:count]
    return first
