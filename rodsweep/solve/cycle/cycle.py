"""Request and outcome of one point of the task limit_cycle."""

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
class MotionShapes:
    """The beginning of a motion: shapes (x, y), (2, frames, nodes), at times `step` apart, in tau2.

    is_whole: whether it goes on until the outcome of the motion is known.
    """

    step: float
    shapes: Array
    is_whole: bool


@dataclass(frozen=True, slots=True)
class CycleRequest:
    """Request for each rod.

    accuracy: relative accuracy of period and extrema. amplitude: tip's y of the start in the leading mode, in
    L. start: "mode" for the leading mode; "neighbour" for the neighbour's cycle, and the leading mode where
    there is no neighbour; "hopf" for the branch from the Hopf point. harmonics: number of harmonics. samples:
    times per period of the tip and the energy, 0 for none. shapes, nodes: shapes per period, 0 for none, and
    Lobatto nodes of each shape. most_periods: maximum number of returns of the tip. transient: stored times
    of the tip's path from the start, 0 for none. For a stored path the motion is always integrated, and
    without jumps.
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
    tip: tuple[float, float] | None = None
    frames: int = 0

    @property
    def is_traced(self) -> bool:
        """Whether the motion from the start is stored, and so always integrated."""
        return self.transient > 0 or self.frames > 0


@dataclass(frozen=True, kw_only=True)
class Cycle:
    """Outcome for one rod, with the numbers of its cycle; NaN or None where a number is not known.

    linear_growth_rate, linear_frequency: leading mode of the straight rod, in 1/tau2. periods: returns of the
    tip in the integrated motion. second_state: a SecondState; subcritical_F: force of the Hopf point that
    makes a second state possible. multiplier: modulus of the largest nontrivial Floquet multiplier;
    multipliers: the largest multipliers, complex, (STORED_MULTIPLIERS,); trivial_multiplier_error: distance
    of the trivial multiplier from 1. On a torus only the multipliers are known; they belong to the unstable
    cycle inside the torus.

    tip: x, y, theta at equidistant times, (3, samples). energy: U in k3/L, injection, dissipation, (3,
    samples). shape: x, y, theta, (3, shapes, nodes). Time starts where the tip's y rises through its mean.
    transient: time in tau2 and x, y, theta of the tip, from the start to the end of the integration, (4,
    transient); None if no motion was integrated. motion: shapes from the start, if requested. neighbour: data
    from which the next point of a chain starts.
    """

    status: PointStatus
    message: str = ""
    seconds: float = 0.0
    linear_growth_rate: float = nan
    linear_frequency: float = nan
    periods: int = 0
    second_state: int = SecondState.not_known
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
    motion: MotionShapes | None = None
    neighbour: Neighbour | None = None


def measured(
    cycle: Cycle, request: CycleRequest, path: CyclePath, measures: Measures, errors: CycleErrors
) -> Cycle:
    """The outcome with the numbers of a cycle, and the requested parts of the path."""
    mesh = path.orbit.form.mesh
    # Unresolved harmonics are smaller than the cycle's error, so 0 is correct within that error.
    amplitudes = padded(measures.harmonic_amplitude, request.harmonics, 0.0)
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


def padded(values: Array | Complex, count: int, filler: complex) -> Any:
    """The first values of (m,), (count,), with a filler in the places beyond m."""
    first = np.full(count, filler, values.dtype)
    first[: len(values)] = values[:count]
    return first
