"""How far a perturbation of a stable rod can grow in the Gamma norm, S = sup_t |exp(L t)|.

With a the numerical abscissa |exp(L t)| <= exp(a t), on a mesh as well as in the rod (the form that bounds
both is the same). So nothing that a mesh gets wrong at times t < log(S)/a can matter, and no more
modes are needed than make exp(a t) <= S at the first time at which they represent exp(L t). From there on
`rodsweep.solve.modes.norm_maximum` bounds it between all times, up to one after which it only shrinks.

S is asked for to an accuracy relative to itself. Where a is just above 0 the growth S - 1 is like a^3 where
shear leads and like a^5 where bending does, and early; below the accuracy it is reported as 1 at 0.
"""

from dataclasses import dataclass, replace
from math import ceil, exp, inf, isnan, log, nan, pi, sqrt
from typing import Any

import numpy as np

from ...discretization.straight.dense_form import AnyPencil, dense_form
from ...model.rod import Rod
from .norm_maximum import LARGEST_EXPONENT, highest
from .numerical_abscissa import numerical_abscissa
from .problem import ModesProblem
from .propagator import Propagator, shifted_inverse

FEWEST_MODES, MORE_MODES = 8, 1.5
"""Modes that represent exp(L t) at first, and the factor to the next attempt."""
TRUNCATION_MARGIN = 4.0
"""exp(-this): share of the accuracy that the modes left out may use up."""
SEARCH_SHARE, LEAST_SEARCH_TOLERANCE = 0.25, 2e-13
"""Share of the accuracy left open between times, and the rounding below which it would be in vain."""
FIRST_FINER, ORDER_FACTOR, MOST_GROWTH_MESHES = 4, 1.4, 5
"""How much finer the second mesh is, and the factor to the next: layers at the tip ask for high orders."""
MOST_GROWTH_UNKNOWNS = 400
"""Unknowns beyond which no further mesh is tried: all of its modes take a second."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Growth:
    """What a perturbation does before it decays; NaN where it was not asked for.

    transient_growth: sup_t |exp(L t)| in the Gamma norm, transient_time: when, in tau2: 1 at 0 where it
    exceeds 1 by no more than growth_error, inf at inf for an unstable rod, NaN where stability is undecided;
    growth_error: relative. The time is as accurate as a flat maximum allows.
    numerical_abscissa: sup Re (xi, L xi)/(xi, xi), the growth rate at t = 0+, in 1/tau2; abscissa_error.
    """

    transient_growth: float = nan
    transient_time: float = nan
    growth_error: float = nan
    numerical_abscissa: float = nan
    abscissa_error: float = nan

    def errors(self, rate: float) -> dict[str, float]:
        """Relative errors by quantity; that of the abscissa next to `rate`, where the latter is larger."""
        scale = max(abs(self.numerical_abscissa), rate)
        return {"transient growth": self.growth_error, "numerical abscissa": self.abscissa_error / scale}


KNOWN = {
    True: None,
    False: Growth(transient_growth=inf, transient_time=inf, growth_error=0.0),
    None: Growth(growth_error=0.0),
}
"""The growth where stability alone says what it is."""
UNBOUNDED = Growth(growth_error=inf)
"""The growth of which nothing is known."""


def growth_of(problem: ModesProblem, mesh: Any, accuracy: float, stable: bool | None, rate: float) -> Growth:
    """Abscissa and growth on meshes from `mesh` on; `rate` is the modulus of the leading eigenvalue.

    A rod that is not `stable` grows without end; where that is not known (None), the growth is nan.
    """
    best, least, rod = UNBOUNDED, inf, problem.rod
    abscissa, coarse = numerical_abscissa(rod, problem.pencil(mesh)), None
    for step in range(MOST_GROWTH_MESHES):
        order = mesh.order + FIRST_FINER if step == 0 else ceil(ORDER_FACTOR * mesh.order)
        last, mesh = mesh, problem.of_order(mesh, order)
        if step and mesh.unknowns > MOST_GROWTH_UNKNOWNS:
            break
        pencil = problem.pencil(mesh)
        before, abscissa = abscissa, numerical_abscissa(rod, pencil)
        change = abs(abscissa - before)
        found = KNOWN[stable]
        if found is None and abscissa + change <= 0:
            found = Growth(transient_growth=1.0, transient_time=0.0, growth_error=0.0)
        if found is None:
            coarse = coarse or propagator_of(rod, problem.pencil(last))
            fine = propagator_of(rod, pencil)
            found, coarse = transient_growth(coarse, fine, abscissa + change, accuracy), fine
        result = replace(found, numerical_abscissa=abscissa, abscissa_error=change)
        error = max(inf if isnan(error) else error for error in result.errors(rate).values())
        improved = error < least / 2
        if error < least or step == 0:
            best, least = result, error
        if least <= accuracy or not improved:
            break
    return best


def propagator_of(rod: Rod, pencil: AnyPencil) -> Propagator:
    """exp(L t) of the rod on one mesh, in coordinates in which the Gamma norm is Euclidean."""
    form = dense_form(rod, pencil)
    return Propagator(shifted_inverse(form.A, form.B, 0.0))


def transient_growth(coarse: Propagator, fine: Propagator, abscissa: float, accuracy: float) -> Growth:
    """The largest growth on the finer mesh, compared with that on the coarser; `abscissa` > 0 is a bound."""
    if isnan(abscissa) or not fine.w[0].real < 0:  # the mesh makes an eigenvalue up that the rod has not
        return UNBOUNDED
    patience = log(1 / accuracy) + TRUNCATION_MARGIN
    tolerance = max(SEARCH_SHARE * accuracy, LEAST_SEARCH_TOLERANCE)
    best, ceiling, tail, k, stop = (1.0, 0.0), 1.0, 0.0, FEWEST_MODES, 0.0
    while True:
        k = fine.keep(k)
        first = patience / abs(fine.w[min(k, len(fine.w) - 1)].real)
        if not stop:
            stop, tail = _end(fine, first, patience)
        if stop > first and fine.norm(first)[0] >= 1:
            peak, bound = highest(fine, (first, stop), abscissa, best[0], tolerance)
            best, ceiling = max(best, peak), max(ceiling, bound)
        stop = first
        before = exp(min(abscissa * first, LARGEST_EXPONENT))
        if before <= best[0] * (1 + tolerance) or k == len(fine.w):
            break
        k = min(int(MORE_MODES * k), len(fine.w))
    hidden = max(ceiling, before) / best[0] - 1 + tail
    if best[0] > 1:
        # The meshes are compared at the peak and half way, in the logarithm, to the earliest time that may
        # matter, the coarser with more modes if it has them.
        coarse.keep(int(MORE_MODES * k))
        times = best[1], sqrt(best[1] * max(first, log(best[0]) / abscissa))
        hidden += max(abs(coarse.norm(t)[0] / fine.norm(t)[0] - 1) for t in times)
    return Growth(transient_growth=best[0], transient_time=best[1], growth_error=hidden)


def _end(propagator: Propagator, first: float, patience: float) -> tuple[float, float]:
    """(a time after which |exp(L t)| is nowhere larger than before, by how much that may fail).

    Since |exp(L (t + r))| <= |exp(L t)| |exp(L r)|, any time does at which it is below 1. Near a threshold
    that is far off; but once the leading pair is alone it repeats itself and shrinks, every half
    period. If the others still carry r then, no later value exceeds all earlier ones by the share 2 r.
    """
    w = propagator.w[: len(propagator.generator)]
    m = 2 if w[0].imag else 1
    gap = w[0].real - w[m].real
    share = 1 / np.linalg.svd(propagator.overlap[:m, :m], compute_uv=False)[-1]
    alone = (patience + log(share)) / gap if gap > 0 else inf
    end = first
    while end < alone:
        if propagator.norm(end)[0] < 1:
            return end, 0.0
        end *= 2
    alone = max(alone, first)
    return alone + (pi / w[0].imag if m == 2 else 0.0), 2 * propagator.left_over(m, alone)
