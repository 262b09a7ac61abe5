"""The numerical abscissa: the largest growth rate of a perturbation in the Gamma norm at t = 0+."""

from dataclasses import dataclass
from math import inf, isnan, nan

import numpy as np

from ...arrays import Array
from ...determinant.arm.hull.hull import hull_of
from ...determinant.certificate.box_of_all_eigenvalues import box_of_all_eigenvalues
from ...discretization.straight.dense_eigenproblem import AnyPencil, dense_eigenproblem
from ...discretization.straight.tip_layer import tip_angle_moment_ratio
from ...model.adjoint_tip_conditions import hermitian_tip_coefficients
from ...model.rod import Rod
from .null_vectors import eigenvalue_rounding, factorised_pencil, null_vectors
from .propagator import symmetrised_shifted_inverse
from .stiffness_matrix import StiffnessMatrix


@dataclass(frozen=True, slots=True, kw_only=True)
class NumericalAbscissaSettings:
    """Settings of the shifts with which the numerical abscissa is computed from above."""

    max_shifts: int = 60
    """Maximum number of shifts; a shift below the numerical abscissa is followed by a shift about twice as
    large."""
    relative_shift_distance_above_abscissa: float = 0.05
    """The next shift lies above the current estimate a of the numerical abscissa by this number times (1 +
    |a|), so close that shift + 1/eigenvalue loses no digits by cancellation. An estimate is final if its own
    shift was at most twice this distance above it."""
    min_positive_over_negative_modulus: float = 1e-9
    """The largest eigenvalue of the shifted inverse is positive, and not a rounding error, if it exceeds this
    fraction of the modulus of the most negative eigenvalue."""
    rounding_safety_factor: float = 8.0
    """Factor from the rms estimate of the rounding error of the abscissa to the stated error; on 200 rods the
    true error was at most 5.2 times the estimate."""


NUMERICAL_ABSCISSA_SETTINGS = NumericalAbscissaSettings()


def numerical_abscissa_and_error(rod: Rod, pencil: AnyPencil, estimate: float = nan) -> tuple[float, float]:
    """Returns (abscissa, rounding error), in 1/tau2. abscissa: sup Re (xi, L xi)/(xi, xi) over the domain of
    the operator L, the largest growth rate at t = 0+, on the mesh of `pencil`. estimate: the abscissa on
    another mesh, NaN if unknown.

    The abscissa is the largest eigenvalue of the Hermitian part of L
    (`rodsweep.model.adjoint_tip_conditions`), which shifts approach from above. nan if no shift lies above
    this eigenvalue, which is possible only for a rod without rotational drag and with `Rod.g` < 0.
    """
    settings = NUMERICAL_ABSCISSA_SETTINGS
    form = dense_eigenproblem(rod, pencil)
    A = form.A_with_tip_terms(*hermitian_tip_coefficients(rod.F, tip_angle_moment_ratio(rod)))
    matrix = StiffnessMatrix(A, form.bending_factor)
    B = form.B
    shift = _shift_above(estimate)
    if isnan(estimate):
        bound, _ = box_of_all_eigenvalues(rod) if rod.is_uniform_and_linear else hull_of(rod).box()
        # Any shift above the abscissa is allowed; the bound of the eigenvalues is the first guess.
        shift = bound + 1 if bound < inf else rod.F**2 + 1
    for _ in range(settings.max_shifts):
        H = symmetrised_shifted_inverse(A, B, shift)
        # H is symmetric but for rounding errors, and `eigvalsh` would read only one of its triangles.
        eigenvalues = np.linalg.eigvalsh((H + H.T) / 2)
        # A positive eigenvalue: an eigenvalue of the operator lies above the shift.
        if eigenvalues[-1] > -settings.min_positive_over_negative_modulus * eigenvalues[0]:
            shift = 2 * abs(shift) + 1
            continue
        # Eigenvalues of the inverse of (L + L+)/2 - shift, all negative above the abscissa; the most negative
        # is nearest.
        abscissa = shift + 1 / float(eigenvalues[0])
        is_close = _shift_above(abscissa)
        if shift - abscissa <= 2 * (is_close - abscissa):
            return _rayleigh_quotient_and_rounding(matrix, B, abscissa)
        # A shift far above the abscissa cancels in shift + 1/value: one more solve close to it restores the
        # digits.
        shift = is_close
    return nan, nan


def _rayleigh_quotient_and_rounding(matrix: StiffnessMatrix, B: Array, w: float) -> tuple[float, float]:
    """Returns (eigenvalue of the pencil (A, diag(B)) nearest to `w`, rounding error), in 1/tau2. matrix: the
    matrix A.

    The error of the Rayleigh quotient is the rounding of a product with A alone; that of an eigenvalue of the
    inverse is up to 20 times larger.
    """
    x, z = null_vectors(factorised_pencil(matrix, B, w))
    rounding = NUMERICAL_ABSCISSA_SETTINGS.rounding_safety_factor * eigenvalue_rounding(matrix, B, x, z)
    return float(z @ matrix.product(x, 0) / (z @ (B * x))), rounding


def _shift_above(abscissa: float) -> float:
    """Shift close above `abscissa`, in 1/tau2."""
    distance = NUMERICAL_ABSCISSA_SETTINGS.relative_shift_distance_above_abscissa
    return abscissa + distance * (1 + abs(abscissa))
