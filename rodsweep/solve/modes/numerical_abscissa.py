"""The numerical abscissa: the largest growth rate of a perturbation in the Gamma norm at t = 0+."""

from math import inf, nan

import numpy as np

from ...determinant.arm.hull import hull_of
from ...determinant.certificate.box import eigenvalue_box
from ...discretization.straight.dense_form import AnyPencil, dense_form
from ...discretization.straight.slaving import slaving_of
from ...model.adjoint import hermitian_tip
from ...model.rod import Rod
from .propagator import shifted_inverse

MAX_ABSCISSA_SHIFTS = 60
"""Maximum number of shifts tried to exceed the numerical abscissa if no bound is known; each doubles the
last."""
CLOSE_SHIFT = 0.05
"""Relative distance of a shift above the abscissa that costs no digits."""
POSITIVE = 1e-9
"""Relative size above which an eigenvalue of the shifted inverse is positive, not rounding."""


def numerical_abscissa(rod: Rod, pencil: AnyPencil) -> float:
    """sup Re (xi, L xi)/(xi, xi) over the domain of L, in 1/tau2: the largest growth rate at t = 0+.

    The largest eigenvalue of the Hermitian part (`rodsweep.model.adjoint`), approached by shifts from above.
    nan if no shift lies above it, which is possible only for a rod without rotational drag and with g < 0.
    """
    form = dense_form(rod, pencil)
    A = form.averaged(*hermitian_tip(rod.F, slaving_of(rod)))
    B = form.B
    bound, _ = eigenvalue_box(rod) if rod.standard else hull_of(rod).box()
    shift = bound + 1 if bound < inf else rod.F**2 + 1
    for _ in range(MAX_ABSCISSA_SHIFTS):
        H = shifted_inverse(A, B, shift)
        values = np.linalg.eigvalsh((H + H.T) / 2)
        if values[-1] > -POSITIVE * values[0]:  # an eigenvalue lies above the shift
            shift = 2 * abs(shift) + 1
            continue
        abscissa = shift + 1 / float(values[0])
        close = abscissa + CLOSE_SHIFT * abs(abscissa) + CLOSE_SHIFT
        if shift - abscissa <= 2 * (close - abscissa):
            return abscissa
        shift = close
    return nan
