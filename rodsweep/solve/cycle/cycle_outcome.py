"""Request and outcome of the task limit_cycle for one rod."""

from dataclasses import dataclass, replace
from math import nan
from typing import Any

import numpy as np

from ...arrays import Array, Complex
from ..orbit.measures import CycleMeasures, CycleMotion
from ..status import PointStatus
from .accuracy.cycle_errors import UNKNOWN_ERRORS, CycleErrors
from .accuracy.refined_cycle import RefinedCycle
from .cycle_of_neighbouring_rod import CycleStart
from .second_state import SecondStableState
from .status import CycleStatus


@dataclass(frozen=True, slots=True, kw_only=True)
class MultiplierListSettings:
    """Settings for the list of stored Floquet multipliers of a cycle."""

    length: int = 6
    """Number of nontrivial Floquet multipliers per cycle in a result file."""
    min_modulus: float = 1e-6
    """Smallest modulus of a stored multiplier; a perturbation with a smaller multiplier has decayed after one
    period."""


MULTIPLIER_LIST_SETTINGS = MultiplierListSettings()
NO_MULTIPLIER = complex(nan, nan)
"""Entry of the list for a missing multiplier, or for a multiplier whose modulus is less than
`MULTIPLIER_LIST_SETTINGS.min_modulus`."""


@dataclass(frozen=True, slots=True)
class MotionShapes:
    """Shapes of the rod at equidistant times from the start of a motion, for an animation.

    shapes: x, y in L, (2, frames, nodes). time_step: time between two shapes, in tau2. covers_whole_motion:
    False if the maximum number of time steps or of shapes cut off the end of the motion.
    """

    time_step: float
    shapes: Array
    covers_whole_motion: bool


@dataclass(frozen=True, slots=True)
class CycleRequest:
    """Request of the task limit_cycle, the same for every rod of a sweep: accuracy, start of the search,
    quantities to store."""

    accuracy: float
    """Relative accuracy of the period and of the largest y of the tip."""
    amplitude: float
    """Tip's y, in L, at the start of a motion in the leading mode."""
    harmonics: int
    """Number of stored harmonics of the tip's y."""
    samples: int
    """Number of times per period at which tip and energy are stored; 0 to store neither tip nor energy."""
    shapes: int
    """Number of stored shapes of the rod per period; 0 for no shapes."""
    nodes: int
    """Number of Lobatto nodes of each stored shape."""
    most_periods: int
    """The integration of a motion ends after this number of periods, counted as returns of the tip to theta =
    0."""
    start: str = "mode"
    """Start of the search: "mode" for the leading mode; "neighbour" for the cycle of the neighbouring rod, or
    the leading mode if there is no neighbour; "hopf" for the branch from the Hopf point below the force."""
    transient: int = 0
    """Number of times at which the tip's path from the start is stored; 0 for no path. A motion with a stored
    path is always integrated, without scaling of its state."""
    tip: tuple[float, float] | None = None
    """x, y of the tip, in L, at the start of the motion; None if the field `start` determines the start."""
    frames: int = 0
    """Number of shapes per return of the tip that are stored for an animation; 0 for no animation."""

    @property
    def is_motion_recorded(self) -> bool:
        """Whether the tip's path or the rod's shapes are stored from the start of the motion on; the motion
        is then always integrated."""
        return self.transient > 0 or self.frames > 0


@dataclass(frozen=True, kw_only=True)
class CycleOutcome:
    """Outcome of the task limit_cycle for one rod, with the quantities of the cycle; unknown quantities are
    NaN or None. message: for the user, or "". seconds: computing time, in s. elements, order: number and
    order of the elements of the mesh, 0 if unknown.

    For a motion on a torus only the multipliers of the unstable cycle inside the torus are known. Time series
    over a period start where the tip's y rises through its mean.
    """

    status: PointStatus
    """Final state of the rod, or reason why it is not known."""
    message: str = ""
    seconds: float = 0.0
    linear_growth_rate: float = nan
    """Growth rate of the leading mode of the straight rod, in 1/tau2."""
    linear_frequency: float = nan
    """Frequency of the leading mode of the straight rod, in 1/tau2."""
    periods: int = 0
    """Number of returns of the tip in the integrated motion; 0 if no motion was integrated."""
    second_state: int = SecondStableState.not_known
    """Second stable state of the rod, as a value of `SecondStableState`."""
    subcritical_F: float = nan
    """Force, in k3/L^2, of the subcritical Hopf point that makes a second stable state possible; NaN if no
    such Hopf point is known."""
    elements: int = 0
    order: int = 0
    measures: CycleMeasures = CycleMeasures()
    """Period, extrema, harmonics and powers of the cycle; NaN if no cycle is known."""
    errors: CycleErrors = UNKNOWN_ERRORS
    """Error estimates of the cycle; NaN if no cycle is known."""
    multiplier: float = nan
    """Modulus of the largest nontrivial Floquet multiplier."""
    multipliers: Complex | None = None
    """Largest nontrivial Floquet multipliers by descending modulus, padded with NaN,
    (MULTIPLIER_LIST_SETTINGS.length,)."""
    trivial_multiplier_error: float = nan
    """Modulus of the difference between the computed trivial multiplier and 1."""
    modulation_ratio: float = nan
    """Frequency of the modulation of a motion on a torus, divided by the frequency of its oscillation, from
    the integrated motion; NaN for other motions."""
    tip: Array | None = None
    """x, y (in L) and theta of the tip at equidistant times over a period, (3, samples)."""
    energy_and_powers: Array | None = None
    """Elastic energy, in k3/L, injected power and dissipated power, in k3/(L tau2), at equidistant times over
    a period, (3, samples)."""
    shape: Array | None = None
    """x, y (in L) and theta of the rod at equidistant times over a period, (3, shapes, nodes)."""
    transient_tip_path: Array | None = None
    """Time in tau2, and x, y (in L) and theta of the tip, at equidistant times of the integrated motion,
    (4, transient); None if no path was requested or no motion was integrated."""
    motion_shapes: MotionShapes | None = None
    """Shapes of the rod from the start of the motion, if requested."""
    start_for_next_rod: CycleStart | None = None
    """Data of this cycle from which the search for the next rod of a chain, a sequence of neighbouring rods,
    starts; None outside a chain."""


def with_measures(
    cycle: CycleOutcome,
    request: CycleRequest,
    motion: CycleMotion,
    measures: CycleMeasures,
    errors: CycleErrors,
) -> CycleOutcome:
    """The outcome `cycle` with the mesh, measures, errors and requested time series of a solved cycle.
    motion: motion of this cycle over its period."""
    mesh = motion.orbit.form.mesh
    # Unresolved harmonics are smaller than the cycle's error, so 0 is correct within this error.
    amplitudes = padded_or_cut(measures.harmonic_amplitude, request.harmonics, 0.0)
    return replace(
        cycle,
        elements=mesh.element_count,
        order=mesh.order,
        measures=replace(measures, harmonic_amplitude=amplitudes),
        errors=errors,
        tip=motion.tip_x_y_theta_from_mean_crossing(request.samples) if request.samples else None,
        energy_and_powers=motion.energy_and_powers_from_mean_crossing(request.samples)
        if request.samples
        else None,
        shape=motion.shapes_from_mean_crossing(request.shapes, request.nodes) if request.shapes else None,
    )


def padded_or_cut(values: Array | Complex, count: int, fill_value: complex) -> Any:
    """The first `count` entries of `values`, (m,), padded with `fill_value` if m < count; shape (count,)."""
    padded = np.full(count, fill_value, values.dtype)
    padded[: len(values)] = values[:count]
    return padded


def with_cycle_quantities(cycle: CycleOutcome, refined: RefinedCycle, request: CycleRequest) -> CycleOutcome:
    """The outcome `cycle` with the measures, errors, time series and multipliers of the solved cycle
    `refined`."""
    cycle = with_measures(cycle, request, refined.motion, refined.measures, refined.errors)
    return with_multipliers(cycle, refined)


def with_multipliers(cycle: CycleOutcome, refined: RefinedCycle) -> CycleOutcome:
    """The outcome `cycle` with multipliers of the solved cycle `refined`: the largest modulus, the stored
    list (cut or padded; NO_MULTIPLIER replaces small multipliers), and their errors."""
    multipliers = padded_or_cut(refined.multipliers, MULTIPLIER_LIST_SETTINGS.length, NO_MULTIPLIER)
    # Tiny multipliers consist of rounding errors, and would differ from run to run.
    multipliers[np.abs(multipliers) < MULTIPLIER_LIST_SETTINGS.min_modulus] = NO_MULTIPLIER
    return replace(
        cycle,
        multiplier=refined.largest_multiplier_modulus,
        multipliers=multipliers,
        trivial_multiplier_error=refined.trivial_multiplier_error,
        errors=replace(cycle.errors, multiplier_error=refined.errors.multiplier_error),
    )


@dataclass(frozen=True, eq=False)
class TransientOutcome:
    """Outcome of integrating a motion. return_count: number of returns of the tip. cycle: the cycle that the
    motion approached, or None. unstable_cycle: the unstable cycle inside the torus, or None if the motion is
    not on a torus. modulation_ratio: frequency of the modulation of a motion on a torus over the frequency of
    its oscillation; NaN for other motions."""

    status: CycleStatus
    """Kind of the motion's final state, or reason why it is not known."""
    message: str
    """Explanation of the status for the user; may be ""."""
    return_count: int
    cycle: RefinedCycle | None = None
    unstable_cycle: RefinedCycle | None = None
    modulation_ratio: float = nan
