"""Largest transient growth of a perturbation of a stable straight rod in the Gamma norm, S = sup_t |exp(L
t)|.

With the numerical abscissa a, |exp(L t)| <= exp(a t), on a mesh and in the rod, because one quadratic form
bounds both norms. Errors of a mesh at times t < log(S)/a therefore do not matter. The number of modes is
sufficient if exp(a t) <= S at the first time at which the modes represent exp(L t). From this time on
`rodsweep.solve.modes.norm_maximum` bounds the norm, up to a time after which the norm only decays.

The accuracy is relative to S. For a just above 0 the growth S - 1 is proportional to a^3 if shear dominates
and to a^5 if bending dominates, and occurs early; growth below the accuracy is reported as S = 1 at t = 0.
"""

from dataclasses import dataclass, replace
from math import ceil, exp, expm1, inf, isnan, log, nan, pi, sqrt

import numpy as np

from ...discretization.straight.dense_eigenproblem import AnyPencil, dense_eigenproblem
from ...discretization.straight.transverse_mesh import AnyMesh, pencil_on
from ...model.rod import Rod
from .norm_maximum import NORM_MAXIMUM_SETTINGS, maximum_propagator_norm
from .numerical_abscissa import numerical_abscissa_and_error
from .propagator import Propagator, symmetrised_shifted_inverse


@dataclass(frozen=True, slots=True, kw_only=True)
class GrowthSettings:
    """Settings for the number of modes and the meshes from which the transient growth is computed."""

    initial_mode_count: int = 8
    """Initial number of leading modes that represent exp(L t)."""
    mode_increase_fraction: float = 0.5
    """Relative increase of the number of modes if more modes are needed."""
    truncation_exponent: float = 4.0
    """The omitted modes contribute at most exp(-`truncation_exponent`) times the accuracy."""
    search_tolerance_over_accuracy: float = 0.25
    """Tolerance of `maximum_propagator_norm`, as a fraction of the requested accuracy."""
    min_search_tolerance: float = 2e-13
    """Smallest tolerance of `maximum_propagator_norm`: rounding error of the norm."""
    order_increase: int = 4
    """Increase of the element order from the first mesh to the second."""
    further_mesh_order_ratio: float = 1.4
    """Element order of a further mesh, divided by the order before; boundary layers at the tip need high
    orders."""
    max_finer_meshes: int = 5
    """Maximum number of meshes after the first, each finer than its predecessor."""
    max_unknowns: int = 400
    """Maximum number of unknowns of a further mesh; to compute all modes of a larger mesh takes more than a
    second."""


GROWTH_SETTINGS = GrowthSettings()


@dataclass(frozen=True, slots=True, kw_only=True)
class TransientGrowth:
    """Transient growth of perturbations of a straight rod, with errors; NaN if not requested."""

    transient_growth: float = nan
    """Largest growth sup_t |exp(L t)| in the Gamma norm. For an unstable rod `transient_growth` and
    `transient_time` are inf; if stability is undecided they are NaN."""
    transient_time: float = nan
    """Time of the largest growth, in tau2; inaccurate if the maximum is flat. 0 if no norm above 1 is found;
    the growth, which exceeds 1 by at most `growth_error`, is then stated as 1."""
    growth_error: float = nan
    """Relative error of `transient_growth`."""
    numerical_abscissa: float = nan
    """Growth rate at t = 0+, sup Re (xi, L xi)/(xi, xi), L: operator of the rod, in 1/tau2."""
    abscissa_error: float = nan
    """Absolute error of `numerical_abscissa`."""

    def relative_errors_by_name(self, abs_w: float) -> dict[str, float]:
        """Relative errors of the growth and of the numerical abscissa, by name. The error of the abscissa is
        divided by the larger of |abscissa| and `abs_w`, in 1/tau2."""
        scale = max(abs(self.numerical_abscissa), abs_w)
        return {"transient growth": self.growth_error, "numerical abscissa": self.abscissa_error / scale}


GROWTH_BY_STABILITY = {
    True: None,
    False: TransientGrowth(transient_growth=inf, transient_time=inf, growth_error=0.0),
    None: TransientGrowth(growth_error=0.0),
}
"""`TransientGrowth` by stability (True, False, None if undecided); None for a stable rod, whose growth must
be computed."""
UNKNOWN_GROWTH = TransientGrowth(growth_error=inf)
"""Growth after a failed computation: NaN with infinite error."""


def converged_transient_growth(
    rod: Rod, mesh: AnyMesh, accuracy: float, is_stable: bool | None, abs_w: float
) -> TransientGrowth:
    """Numerical abscissa and transient growth of a rod, from `mesh` and finer meshes. accuracy: requested
    relative accuracy. abs_w: modulus of the leading eigenvalue, in 1/tau2. is_stable: whether the
    rod is stable, None if undecided. The growth is inf for an unstable rod, NaN if undecided."""
    best_growth = UNKNOWN_GROWTH
    min_error = inf
    abscissa, _ = numerical_abscissa_and_error(rod, pencil_on(mesh))
    coarse_propagator = None
    for step in range(GROWTH_SETTINGS.max_finer_meshes):
        order = (
            mesh.order + GROWTH_SETTINGS.order_increase
            if step == 0
            else ceil(GROWTH_SETTINGS.further_mesh_order_ratio * mesh.order)
        )
        previous_mesh = mesh
        mesh = replace(mesh, order=order)
        if step and mesh.unknown_count > GROWTH_SETTINGS.max_unknowns:
            break
        pencil = pencil_on(mesh)
        previous_abscissa = abscissa
        abscissa, rounding = numerical_abscissa_and_error(rod, pencil, previous_abscissa)
        abscissa_change = abs(abscissa - previous_abscissa) + rounding
        growth = GROWTH_BY_STABILITY[is_stable]
        # Without growth at t = 0+ there is no later growth: the norm of exp(L t) decreases from 1.
        if growth is None and abscissa + abscissa_change <= 0:
            growth = TransientGrowth(transient_growth=1.0, transient_time=0.0, growth_error=0.0)
        if growth is None:
            coarse_propagator = coarse_propagator or propagator_of(rod, pencil_on(previous_mesh), abscissa)
            fine_propagator = propagator_of(rod, pencil, abscissa)
            growth = transient_growth(
                coarse_propagator, fine_propagator, abscissa + abscissa_change, accuracy
            )
            coarse_propagator = fine_propagator
        result = replace(growth, numerical_abscissa=abscissa, abscissa_error=abscissa_change)
        error = max(inf if isnan(e) else e for e in result.relative_errors_by_name(abs_w).values())
        has_improved = error < min_error / 2
        if error < min_error or step == 0:
            best_growth = result
            min_error = error
        if min_error <= accuracy or not has_improved:
            break
    return best_growth


def propagator_of(rod: Rod, pencil: AnyPencil, abscissa: float) -> Propagator:
    """exp(L t) of the rod on the mesh of `pencil`, in coordinates in which the Gamma norm is Euclidean, from
    the inverse of L - shift. abscissa: numerical abscissa a of a stable rod, in 1/tau2.

    The leading eigenvalue of a pulled rod is of order exp(F), and without a shift its inverse would hide all
    other modes. A shift of sqrt(a), of order |F|, is comparable with the decay rates of the other modes.
    """
    form = dense_eigenproblem(rod, pencil)
    # In this order `max` returns 0 for an abscissa that is not known, NaN.
    shift = sqrt(max(0.0, abscissa))
    return Propagator(symmetrised_shifted_inverse(form.A, form.B, shift), shift)


def transient_growth(
    coarse: Propagator, fine: Propagator, abscissa: float, accuracy: float
) -> TransientGrowth:
    """Largest growth from the propagator `fine`; the error is estimated with the propagator
    `coarse` of a coarser mesh. abscissa: an upper bound > 0 of the numerical abscissa. accuracy:
    requested relative accuracy. `UNKNOWN_GROWTH` if `abscissa` is NaN or no digit is known. The rod is
    stable; the growth of a spurious eigenvalue of the mesh with Re w > 0 is part of the error."""
    if isnan(abscissa):
        return UNKNOWN_GROWTH
    decay_exponent = log(1 / accuracy) + GROWTH_SETTINGS.truncation_exponent
    tolerance = max(
        GROWTH_SETTINGS.search_tolerance_over_accuracy * accuracy, GROWTH_SETTINGS.min_search_tolerance
    )
    maximum = (1.0, 0.0)
    upper_bound = 1.0
    later_excess = end_time = 0.0
    mode_count = GROWTH_SETTINGS.initial_mode_count
    while True:
        mode_count = fine.use_leading_modes(mode_count)
        # After this time the omitted modes have decayed to the accuracy; before, more modes are needed.
        first_time = decay_exponent / abs(fine.w[min(mode_count, len(fine.w) - 1)].real)
        if not end_time:
            end_time, later_excess = _end_of_growth_and_excess(fine, first_time, decay_exponent)
            spurious_exponent = max(fine.w[0].real, 0.0) * end_time
            later_excess += expm1(min(spurious_exponent, NORM_MAXIMUM_SETTINGS.max_exponent))
        if end_time > first_time and fine.norm_and_log_slope(first_time)[0] >= 1:
            peak = maximum_propagator_norm(fine, (first_time, end_time), abscissa, maximum[0], tolerance)
            maximum = max(maximum, (peak.norm, peak.time))
            upper_bound = max(upper_bound, peak.upper_bound)
        # With more modes, only the times before the present first time are left to search.
        end_time = first_time
        # |exp(L t)| <= exp(abscissa t) bounds the growth over the early times that the modes do not resolve.
        early_bound = exp(min(abscissa * first_time, NORM_MAXIMUM_SETTINGS.max_exponent))
        if early_bound <= maximum[0] * (1 + tolerance) or mode_count == len(fine.w):
            break
        mode_count = min(int((1 + GROWTH_SETTINGS.mode_increase_fraction) * mode_count), len(fine.w))
    error = max(upper_bound, early_bound) / maximum[0] - 1 + later_excess
    if maximum[0] > 1:
        # The meshes are compared at the peak and at the geometric mean of the peak's time and the earliest
        # time that may matter; the coarser mesh uses more modes if possible.
        coarse.use_leading_modes(int((1 + GROWTH_SETTINGS.mode_increase_fraction) * mode_count))
        compared_times = maximum[1], sqrt(maximum[1] * max(first_time, log(maximum[0]) / abscissa))
        error += max(
            abs(coarse.norm_and_log_slope(t)[0] / fine.norm_and_log_slope(t)[0] - 1) for t in compared_times
        )
    if error >= 1:
        return UNKNOWN_GROWTH
    return TransientGrowth(transient_growth=maximum[0], transient_time=maximum[1], growth_error=error)


def _end_of_growth_and_excess(
    propagator: Propagator, earliest_end: float, decay_exponent: float
) -> tuple[float, float]:
    """Returns (end, excess). end: a time after which |exp(L t)| does not exceed its earlier values. excess:
    relative amount by which a norm after `end` may still exceed these values. earliest_end: earliest end, in
    tau2. decay_exponent: the modes beyond the leading one or pair are negligible once they are
    exp(-decay_exponent) times the leading modes.

    Since |exp(L (t + r))| <= |exp(L t)| |exp(L r)|, any time with |exp(L t)| < 1 is an end. Near a threshold
    such a time is very late. But once the leading pair dominates, the motion repeats itself and shrinks every
    half period. If the other modes contribute the fraction e of the norm at that time, no later norm exceeds
    all earlier norms by more than the fraction 2 e.
    """
    w = propagator.w[: len(propagator.generator)]
    leading_count = 2 if w[0].imag else 1
    rate_gap = w[0].real - w[leading_count].real
    # Norm of the projection onto the leading modes: how large non-normal modes may become before they decay.
    norm = 1 / np.linalg.svd(propagator.overlap[:leading_count, :leading_count], compute_uv=False)[-1]
    pair_only_time = (decay_exponent + log(norm)) / rate_gap if rate_gap > 0 else inf
    end = earliest_end
    while end < pair_only_time:
        if propagator.norm_and_log_slope(end)[0] < 1:
            return end, 0.0
        end *= 2
    pair_only_time = max(pair_only_time, earliest_end)
    # The norm of a decaying pair repeats with half its period, so a maximum may be half a period later.
    return pair_only_time + (
        pi / w[0].imag if leading_count == 2 else 0.0
    ), 2 * propagator.norm_of_truncated_modes(leading_count, pair_only_time)
