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
    """Request for the cycle of a rod."""

    accuracy: float
    """Relative accuracy of period and extrema."""
    amplitude: float
    """Tip's y of the start in the leading mode, in L."""
    harmonics: int
    """Number of harmonics of the tip's y to store."""
    samples: int
    """Times per period at which the tip and the energy are stored, 0 for none."""
    shapes: int
    """Shapes per period, 0 for none."""
    nodes: int
    """Lobatto nodes of each shape."""
    most_periods: int
    """Maximum number of returns of the tip."""
    start: str = "mode"
    """Start of the search: "mode" for the leading mode; "neighbour" for the neighbour's cycle, or the leading
    mode without a neighbour; "hopf" for the branch from the Hopf point."""
    transient: int = 0
    """Number of times at which the tip's path from the start is stored, 0 for none. For a stored path the
    motion is always integrated, and without jumps."""
    tip: tuple[float, float] | None = None
    frames: int = 0

    @property
    def is_traced(self) -> bool:
        """Whether the motion from the start is stored, and so always integrated."""
        return self.transient > 0 or self.frames > 0


@dataclass(frozen=True, kw_only=True)
class Cycle:
    """Outcome for one rod, with the numbers of its cycle; NaN or None where a number is not known.

    On a torus only the multipliers are known; they belong to the unstable cycle inside the torus. In stored
    arrays time starts where the tip's y rises through its mean.
    """

    status: PointStatus
    message: str = ""
    seconds: float = 0.0
    linear_growth_rate: float = nan
    """Growth rate of the leading mode of the straight rod, in 1/tau2."""
    linear_frequency: float = nan
    """Frequency of the leading mode of the straight rod, in 1/tau2."""
    periods: int = 0
    """Returns of the tip in the integrated motion."""
    second_state: int = SecondState.not_known
    """A `SecondState`: whether another stable state is known."""
    subcritical_F: float = nan
    """Force of the Hopf point that makes a second state possible."""
    elements: int = 0
    order: int = 0
    measures: Measures = Measures()
    errors: CycleErrors = UNKNOWN_ERRORS
    multiplier: float = nan
    """Modulus of the largest nontrivial Floquet multiplier."""
    multipliers: Complex | None = None
    """The largest multipliers, complex, (MULTIPLIER_LIST.number,)."""
    trivial_multiplier_error: float = nan
    """Distance of the trivial multiplier from 1."""
    tip: Array | None = None
    """x, y, theta of the tip at equidistant times, (3, samples)."""
    energy: Array | None = None
    """Energy U in k3/L, injected and dissipated power, at equidistant times, (3, samples)."""
    shape: Array | None = None
    """x, y, theta at equidistant times, (3, shapes, nodes)."""
    transient: Array | None = None
    """Time in tau2 and x, y, theta of the tip, from the start to the end of the integration, (4, transient);
    None if no motion was integrated."""
    motion: MotionShapes | None = None
    """Shapes from the start, if requested."""
    neighbour: Neighbour | None = None
    """Data from which the next point of a chain starts."""


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
