"""Stability of the straight rod by its exact spectrum, which takes precedence over an integrated motion.

In an integrated motion a Hopf point is slightly displaced by the mesh, and by the replacement of a limiting
rod, such as a rod with k1 = inf, by a nearby rod. The sign of the exact leading growth rate therefore
determines the stability, unless the growth rate is 0 within its error.
"""

from dataclasses import dataclass, field, replace
from math import isnan, nan

import numpy as np

from ...arrays import Array, Complex
from ...determinant.arm.determinant import forget_arm_determinants
from ...determinant.roots.settings import ROOT_SETTINGS
from ...model.rod import Rod
from ..spectrum.path.followed_leader import (
    follow_leader_in_range,
    follow_leading_eigenvalue,
    is_arm_leader_proved_without_count,
)
from ..spectrum.path.leader_in_range import NO_RANGE, ArmRange
from ..spectrum.search import SpectrumRequest, solve_spectrum


@dataclass(frozen=True, slots=True, kw_only=True)
class StraightRodSettings:
    """Settings for the stability of the straight rod by its leading eigenvalue."""

    min_growth_rate_in_errors: float = 4.0
    """The sign of the growth rate Re w is certain if |Re w| exceeds this number times the error estimate of
    the leading eigenvalue w, and `ROOT_SETTINGS.imaginary_axis_tolerance` times |w|. The task spectrum has
    the same criterion."""
    accuracy: float = 1e-9
    """Relative accuracy of the leading eigenvalue."""
    followed_eigenvalue_counts: tuple[int, ...] = (6, 7, 15)
    """Numbers of eigenvalues of a nonuniform arm that are followed along a chain of rods. The numbers are
    tried in this order, until a few values of the characteristic determinant prove at the first rod which
    eigenvalue leads; without such a proof, the first number is used. A count of the eigenvalues takes three
    times as long as this proof. Of 14 random arms, 10 need six eigenvalues, 3 need seven, and 1 needs twelve.
    Two cones need ten and fifteen; with more eigenvalues than necessary the proof takes less time."""


STRAIGHT_ROD_SETTINGS = StraightRodSettings()


NO_EIGENVALUES: Complex = np.empty(0, complex)


@dataclass(frozen=True, slots=True)
class StraightRodStability:
    """Leading eigenvalue w of the straight rod, Im w >= 0, and its error estimate, in 1/tau2; w and error are
    NaN if w is not known.

    message: reason why w is not known. followed_eigenvalues: eigenvalues that were followed from a similar
    rod, (n,), the leading eigenvalue first; empty if w was found by a search. arm_range: parameter range over
    which the propagators of a chain of arms are interpolated, None without a range, or `NO_RANGE` if only a
    winding number proves that w leads.
    """

    w: complex
    eigenvalue_error: float
    message: str = ""
    followed_eigenvalues: Complex = field(default_factory=NO_EIGENVALUES.copy, compare=False)
    arm_range: ArmRange | None = field(default=None, compare=False)

    @property
    def is_stable(self) -> bool | None:
        """Whether all small motions about the straight rod decay; None if the growth rate is unknown or 0
        within its error."""
        # The error estimate may be smaller than the rounding of w itself.
        margin = max(
            STRAIGHT_ROD_SETTINGS.min_growth_rate_in_errors * self.eigenvalue_error,
            ROOT_SETTINGS.imaginary_axis_tolerance * abs(self.w),
        )
        # A NaN satisfies no comparison, so an unknown eigenvalue gives None.
        return self.w.real < 0 if abs(self.w.real) > margin else None

    def growth_rate(self, default: float) -> float:
        """Growth rate of the leading mode, in 1/tau2; 0 if its sign is undecided, `default` if the
        eigenvalue is unknown."""
        if isnan(self.eigenvalue_error):
            return default
        # A sign within the error must not choose a time scheme or an end state.
        return 0.0 if self.is_stable is None else self.w.real

    @property
    def unproved_stability_text(self) -> str:
        """Message that the straight rod is not proved stable although its integrated motion decays; "" if the
        straight rod is stable."""
        if self.is_stable:
            return ""
        if isnan(self.eigenvalue_error):
            return f"the stability of the straight rod is not known: {self.message}"
        rate = f"the straight rod's growth rate is {self.w.real:.2g} +- {self.eigenvalue_error:.0e}"
        if self.is_stable is None:
            return f"{rate}, so the stability of the straight rod is undecided"
        return f"{rate}, so the straight rod is unstable, although the integrated motion decays"


def straight_rod_stability(
    rod: Rod, near_eigenvalues: Complex | None = None, certify: bool = True
) -> StraightRodStability:
    """The leading eigenvalue of a rod with its error estimate; NaN, with a message, after a failure.

    near_eigenvalues: eigenvalues of a similar rod, (n,), the leading eigenvalue first, which are followed to
    this rod if possible. certify: whether to prove that no other eigenvalue has a larger growth rate.
    """
    forget_arm_determinants()  # made for the Hopf points of a line, on some ranks
    request = SpectrumRequest(1, STRAIGHT_ROD_SETTINGS.accuracy, certify)
    # Following costs a few values of D, where a solve needs meshes.
    leading_w = (
        None
        if near_eigenvalues is None
        else follow_leading_eigenvalue(rod, near_eigenvalues, request.accuracy)
    )
    if leading_w is not None:
        # A proof that needs a count fails in a range, too.
        return StraightRodStability(
            leading_w.w,
            leading_w.error,
            followed_eigenvalues=leading_w.eigenvalues,
            arm_range=NO_RANGE if leading_w.is_proved_by_count else None,
        )
    spectrum = solve_spectrum(rod, request)
    if isnan(spectrum.error_estimate[0]):
        return StraightRodStability(complex(nan, nan), nan, spectrum.message)
    w = complex(spectrum.eigenvalues[0])
    # Both eigenvalues of a pair lead; the upper one stands for them.
    return StraightRodStability(complex(w.real, abs(w.imag)), float(spectrum.error_estimate[0]))


def straight_rod_stability_in_chain(
    rod: Rod, near_eigenvalues: Complex, parameter_name: str | None, arm_range: ArmRange | None
) -> StraightRodStability:
    """`straight_rod_stability` of a rod of a chain. near_eigenvalues: eigenvalues of the previous rod, (n,).
    parameter_name: the varied parameter. arm_range: parameter range with interpolated propagators that
    contains the rod, or None."""
    if parameter_name is None or arm_range is None:
        return straight_rod_stability(rod, near_eigenvalues)
    leading_w = follow_leader_in_range(
        rod, near_eigenvalues, STRAIGHT_ROD_SETTINGS.accuracy, parameter_name, arm_range
    )
    if leading_w is None:
        failed_range = arm_range._replace(successive_failure_count=arm_range.successive_failure_count + 1)
        return replace(straight_rod_stability(rod, near_eigenvalues), arm_range=failed_range)
    return StraightRodStability(
        leading_w.w,
        leading_w.error,
        followed_eigenvalues=leading_w.eigenvalues,
        arm_range=arm_range._replace(successive_failure_count=0.0),
    )


def eigenvalues_to_follow(rod: Rod, stability: StraightRodStability) -> Complex:
    """Eigenvalues of `rod`, (n,), the leading eigenvalue first, from which the eigenvalues of a similar rod
    can be followed: the followed eigenvalues of `stability`, if any; else several eigenvalues of a nonuniform
    rod, if their search succeeds; else the leading eigenvalue of `stability` alone. stability: stability of
    `rod`."""
    if len(stability.followed_eigenvalues):
        return stability.followed_eigenvalues
    if not rod.is_uniform:
        candidates = []
        for number in STRAIGHT_ROD_SETTINGS.followed_eigenvalue_counts:
            w, error = _leading_eigenvalues(rod, number)
            if not np.isfinite(w).all():
                break
            # With too few eigenvalues the proof fails at the next arm too, and a count would be needed there.
            if is_arm_leader_proved_without_count(rod, w, error):
                return w
            candidates.append(w)
        if candidates:
            return candidates[0]
    return np.array([stability.w])


def _leading_eigenvalues(rod: Rod, number: int) -> tuple[Complex, Array]:
    """Returns (eigenvalues, errors), (n,) each: the eigenvalues with Im w >= 0 among the `number` leading
    eigenvalues of `rod`, and their error estimates; NaN if the search fails."""
    spectrum = solve_spectrum(rod, SpectrumRequest(number, STRAIGHT_ROD_SETTINGS.accuracy, True))
    w = spectrum.eigenvalues
    is_kept = ~(w.imag < 0)  # keeps NaN
    return w[is_kept], spectrum.error_estimate[is_kept]


def growth_rate_of_integrated_rod(
    rod: Rod, integrated_rod: Rod, straight: StraightRodStability, rate: float
) -> float:
    """Linear growth rate of `integrated_rod`, in 1/tau2, from its exact spectrum. `integrated_rod` is the rod
    whose motion is integrated in place of a limiting rod, such as a rod with k1 = inf. If both rods are
    equal, or if the spectrum is unknown, the result is `rate`, the growth rate of the rod `rod` with the
    stability `straight`. The growth rate by a stiff matrix would have an error of 1e-4."""
    if integrated_rod == rod:
        return rate
    return straight_rod_stability(integrated_rod, np.array([straight.w])).growth_rate(rate)
