"""D of the arms of a path as a function of the path variable p: eigenvalues with slopes, and double
eigenvalues.

D depends on p through all coefficients along the arm. Where a family of arms
(`rodsweep.determinant.arm.arm_family`) contains the arm at p, D and its derivative by p come from the family.
Elsewhere derivatives by p are differences between determinants of neighbouring arms. The differences need not
be accurate: only Jacobians of Newton's method and predictors use them.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

from ..exponents import EXPONENT_SETTINGS, MACHINE_EPSILON
from ..parameter_path import ParameterPath
from ..roots.newton import FAILED_EIGENVALUE, LocatedEigenvalue
from ..roots.settings import ROOT_NEWTON_SETTINGS, ROOT_SETTINGS
from ..value import DETERMINANT_SETTINGS, DeterminantValue
from .arm_family import ArmFamily
from .arm_family_values import W_and_propagators_at, determinant_of_family_arm, eigenvalue_of_family_arm
from .determinant import ArmDeterminant, arm_determinant
from .newton import refine_eigenvalue_and_error
from .rounding import rounding_error_from_propagators
from .value import determinant_from_propagators

SECOND_ORDER_CENTRAL_STENCIL = ((1, 0.5), (-1, -0.5))
SECOND_ORDER_FORWARD_STENCIL = ((0, -1.5), (1, 2.0), (2, -0.5))
"""Differences of second order for a first derivative: pairs (offset in steps, weight times step)."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ArmDoubleEigenvalueSettings:
    """Settings for double eigenvalues of arms along a path, and for differences by the path variable."""

    max_difference_step_divisions: int = 20
    """Maximum number of difference steps tried, each `difference_step_divisor` times shorter than the last;
    the shortest step is 4e-12 of the first."""
    difference_step_divisor: float = 4.0
    """A difference step is divided by this number if a neighbour is not a valid arm."""


ARM_DOUBLE_EIGENVALUE_SETTINGS = ArmDoubleEigenvalueSettings()


class _DoubleEigenvalueJacobian(NamedTuple):
    """Derivatives of D and D_w by p and w at real w, all times exp(-S), S = `log_scale`."""

    log_scale: float
    D_p: float
    D_ww: float
    D_wp: float


class _DoubleEigenvalueStep(NamedTuple):
    """A step of Newton's method to a double eigenvalue: changes of x and p, and their rounding errors."""

    change_of_x: float
    change_of_p: float
    rounding_error_of_x: float
    rounding_error_of_p: float

    @property
    def errors(self) -> tuple[float, float]:
        """(error of the eigenvalue x, error of the path variable p), each not below the last step."""
        return max(self.rounding_error_of_x, abs(self.change_of_x)), max(
            self.rounding_error_of_p, abs(self.change_of_p)
        )

    def is_converged(self, previous_x_step: float) -> bool:
        """Whether Newton's method has converged: the step in p is of the size of rounding errors, and the
        step in x is either of this size too or more than half as long as the previous step in x,
        `previous_x_step`."""
        converged = ROOT_NEWTON_SETTINGS.converged_step_in_rounding_errors
        return abs(self.change_of_p) <= converged * self.rounding_error_of_p and (
            abs(self.change_of_x) <= converged * self.rounding_error_of_x
            or abs(self.change_of_x) > ROOT_NEWTON_SETTINGS.min_stagnant_step_ratio * previous_x_step
        )


class ArmAlongPath:
    """D of the arms of one path, as a function of the path variable p. family_at: function from p to the
    family of arms that contains p, or to None if D is computed from the arm at p itself."""

    def __init__(self, path: ParameterPath, family_at: Callable[[float], ArmFamily | None] = lambda p: None):
        self.path = path
        self.family_at = family_at

    def determinant(self, p: float) -> ArmDeterminant:
        """The determinant D of the arm at p."""
        return arm_determinant(self.path.rod_at(p))

    def eigenvalue_with_slope_and_error(self, guess: complex, p: float) -> tuple[complex, complex, float]:
        """Returns (w, dw/dp, absolute error of w) of the eigenvalue w near `guess`, for the arm at p: from
        the family of arms around p (propagators interpolated in p) if accurate, else from the arm itself."""
        family = self.family_at(p)
        # The family is valid for |w| <= W; Newton's iterates from |guess| < W/2 stay in this disc.
        if family is not None and abs(guess) < family.largest_w / 2:
            w, slope, error = eigenvalue_of_family_arm(family, guess, p)
            # Near a double eigenvalue the interpolation errors of the family are magnified.
            if error <= ROOT_SETTINGS.min_double_root_correction_over_w * abs(w):
                return w, slope, error
        determinant = self.determinant(p)
        w, error = refine_eigenvalue_and_error(guess, determinant)
        value = determinant.value(w)
        return w, -self.derivative_by_p(w, p, value.log_scale) / value.D_w, error

    def derivative_by_p(self, w: complex, p: float, log_scale: float) -> complex:
        """dD/dp exp(-S) at w and p, by a difference between neighbouring arms; S = `log_scale`."""
        stencil, step = self._difference_stencil_and_step(p, math.inf)
        slope = 0j
        for offset, weight in stencil:
            neighbour = self.determinant(p + offset * step).value(w)
            slope += weight * neighbour.D * math.exp(neighbour.log_scale - log_scale)
        return slope / step

    def double_eigenvalue(self, x: float, p: float, expected_distance: float) -> LocatedEigenvalue:
        """The double real eigenvalue, where D = D_w = 0, near the guess w = x at p, by Newton's method.

        expected_distance: expected distance of p from the guess. Returns `FAILED_EIGENVALUE` if p moves by
        more than twice `expected_distance` or to no valid arm, if the sign of x changes, if the Jacobian is
        singular, or without convergence.
        """
        start_x = x
        start_p = p
        previous_x_step = math.inf
        jacobian: _DoubleEigenvalueJacobian | None = None
        uses_families = True
        # Twice as many steps: Newton's method runs first with families, then with the arms themselves.
        for _ in range(2 * ROOT_NEWTON_SETTINGS.max_steps_to_crossing):
            family = self._usable_family(x, p) if uses_families else None
            # The last Jacobian of the families only affects how fast the arms' own steps converge.
            if uses_families or jacobian is None:
                jacobian = self._jacobian(x, p, expected_distance)
            step = self._newton_step(x, p, jacobian, family)
            x += step.change_of_x
            p += step.change_of_p
            # Negated comparisons are also true for NaN.
            if (
                not abs(p - start_p) <= 2 * expected_distance
                # As D(0) = 1, no branch of real eigenvalues crosses x = 0: the step jumped to another root.
                or not x * start_x > 0
                or not self._is_valid_at(p)
            ):
                return FAILED_EIGENVALUE
            if step.is_converged(previous_x_step):
                if family is None:
                    return LocatedEigenvalue(x, p, *step.errors)
                # The interpolation error of a family is relative to its largest p. The last steps use D of
                # the arms themselves.
                uses_families = False
            previous_x_step = abs(step.change_of_x)
        return FAILED_EIGENVALUE

    def _jacobian(self, x: float, p: float, expected_distance: float) -> _DoubleEigenvalueJacobian:
        """Derivatives of D and D_w at real w = x and p, by differences; expected_distance: see
        `double_eigenvalue`."""
        # Every value is brought to one scale S, since values with different scales cannot be subtracted.
        log_scale = self._determinant_value(x, p).log_scale
        h = DETERMINANT_SETTINGS.second_derivative_step_over_w * abs(x)
        left, right = (self._real_D_and_slope(place, p, log_scale)[1] for place in (x - h, x + h))
        D_ww = (right - left) / (2 * h)
        max_step = ROOT_NEWTON_SETTINGS.relative_jacobian_difference_step * expected_distance
        stencil, k = self._difference_stencil_and_step(p, max_step)
        samples = [
            (weight, self._real_D_and_slope(x, p + offset * k, log_scale)) for offset, weight in stencil
        ]
        D_p, D_wp = (sum(weight * value[i] for weight, value in samples) / k for i in range(2))
        return _DoubleEigenvalueJacobian(log_scale, D_p, D_ww, D_wp)

    def _newton_step(
        self, x: float, p: float, jacobian: _DoubleEigenvalueJacobian, family: ArmFamily | None
    ) -> _DoubleEigenvalueStep:
        """One step of Newton's method for D = D_w = 0 from real w = x and p. D is computed from `family` or,
        if `family` is None, from the arm at p itself. The step is nan if the Jacobian is singular."""
        if family is not None:
            W, polynomials = W_and_propagators_at(family, p)
        else:
            W, polynomials = self.determinant(p).propagators_for(abs(x))
        value = determinant_from_propagators(complex(x, 0.0), W, polynomials)
        log_scale, D_p, D_ww, D_wp = jacobian
        scale = math.exp(value.log_scale - log_scale)
        D = value.D.real * scale
        D_w = value.D_w.real * scale
        cross = D_w * D_wp - D_p * D_ww
        if cross == 0 or not math.isfinite(cross):
            return _DoubleEigenvalueStep(math.nan, math.nan, math.nan, math.nan)
        rounding = rounding_error_from_propagators(complex(x, 0.0), W, polynomials, log_scale)
        # p itself is rounded, which changes D by this much even if D were evaluated exactly.
        total_rounding = rounding + MACHINE_EPSILON * abs(p * D_p)
        rounding_of_slope = rounding / max(abs(x), EXPONENT_SETTINGS.min_divisor)
        x_step = (D_p * D_w - D_wp * D) / cross
        p_step = (D_ww * D - D_w * D_w) / cross
        e_x = (total_rounding * abs(D_wp) + rounding_of_slope * abs(D_p)) / abs(cross)
        return _DoubleEigenvalueStep(x_step, p_step, e_x, total_rounding * abs(D_ww) / abs(cross))

    def _usable_family(self, x: float, p: float) -> ArmFamily | None:
        """The family of arms around p; None if there is none, or if it is not valid at |w| = |x|."""
        family = self.family_at(p)
        return family if family is not None and abs(x) < family.largest_w else None

    def _determinant_value(self, x: float, p: float) -> DeterminantValue:
        """D and D_w at real w = x, for the arm at p."""
        family = self._usable_family(x, p)
        if family is not None:
            return determinant_of_family_arm(family, complex(x, 0.0), p)
        return self.determinant(p).value(complex(x, 0.0))

    def _real_D_and_slope(self, x: float, p: float, log_scale: float) -> tuple[float, float]:
        """Returns (D exp(-S), D_w exp(-S)), both real, at real w = x, for the arm at p; S = `log_scale`."""
        value = self._determinant_value(x, p)
        scale = math.exp(value.log_scale - log_scale)
        return value.D.real * scale, value.D_w.real * scale

    def _difference_stencil_and_step(
        self, p: float, max_step: float
    ) -> tuple[tuple[tuple[int, float], ...], float]:
        """Returns (stencil, step) of a difference by p. stencil: pairs (offset in steps, weight times step).
        step: at most `max_step`.

        Shorter and shorter steps are tried, at most `max_difference_step_divisions`, until all neighbouring
        arms are valid: not crushed, no negative compliance or drag. The stencil is one-sided where no tried
        step has valid arms on both sides, and at p = 0 unless p is the force.
        """
        first_step = min(ROOT_NEWTON_SETTINGS.relative_jacobian_difference_step * max(abs(p), 1.0), max_step)
        # p = 0 ends the range of compliances and drags, but not of the force, which has either sign.
        if p == 0 and self.path.parameter_name != "F":
            return SECOND_ORDER_FORWARD_STENCIL, first_step
        central_step = self._valid_step(p, first_step, SECOND_ORDER_CENTRAL_STENCIL)
        if central_step is not None:
            return SECOND_ORDER_CENTRAL_STENCIL, central_step
        forward_step = self._valid_step(p, first_step, SECOND_ORDER_FORWARD_STENCIL)
        return SECOND_ORDER_FORWARD_STENCIL, forward_step or first_step

    def _valid_step(self, p: float, step: float, stencil: tuple[tuple[int, float], ...]) -> float | None:
        """The difference step `step` at p, shortened until all neighbours of `stencil` are valid arms; None
        if the shortest allowed step has an invalid neighbour."""
        for _ in range(ARM_DOUBLE_EIGENVALUE_SETTINGS.max_difference_step_divisions):
            if all(self._is_valid_at(p + offset * step) for offset, _ in stencil):
                return step
            step /= ARM_DOUBLE_EIGENVALUE_SETTINGS.difference_step_divisor
        return None

    def _is_valid_at(self, p: float) -> bool:
        """Whether the arm at p exists: it is not crushed, and its parameters are in their ranges."""
        try:
            self.path.rod_at(p)
        except ValueError:
            return False
        return True
