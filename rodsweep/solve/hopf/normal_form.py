"""Normal form of a Hopf point: amplitude, frequency and motion of the cycles born there.

About the straight rod the mixed form (`rodsweep.discretization.straight.mixed_form`) is
M dX/dt = A X + B(X, X)/2 + C(X, X, X)/6. With a simple pair of eigenvalues w, conj w of (A, M),
A q = w M q and p^H A = w p^H M, its small motions at a force F' near F are, to second order,

    X = z q + conj(z q) + Re(z^2 h20) + |z|^2 h11,      dz/dt = [w + lambda_F (F' - F)] z + c |z|^2 z,
    h20 = (2 i Im w M - A)^-1 B(q, q),                  h11 = -A^-1 B(q, conj q),
    c = p^H [B(conj q, h20) + 2 B(q, h11) + C(q, q, conj q)]/2,           lambda_F = dw/dF = p^H A_F q.

A linear constitutive law has no cubic term. q is scaled to a tip deflection of 1/2, p to p^H M q = 1: with
z = Z exp(i phase) the tip's y is Re z to second order, and |Z| its largest value in L.

The mirror image of a motion is a motion too: q and p are transverse, h20 and h11 longitudinal. If w has a
real part, away from a Hopf point, h20 and h11 belong to a cycle, on which |z| is constant.
"""

from dataclasses import dataclass
from math import ceil

import numpy as np

from ...arrays import Array, Complex
from ...determinant.wave_number import wave_number
from ...discretization.elements.elements import Elements, equal_edges, halved
from ...discretization.elements.mesh import mesh_on
from ...discretization.elements.resolution import RESOLUTION, resolution_for
from ...discretization.straight.arm_resolution import arm_elements
from ...discretization.straight.elements import LONGITUDINAL, TRANSVERSE, StraightElements
from ...discretization.straight.mixed_form import MixedForm
from ...discretization.straight.whole_matrices import WholeMatrices, straight_matrices
from ...model.rod import Rod
from ..point import Unsolvable


@dataclass(frozen=True, slots=True, kw_only=True)
class NormalFormSettings:
    """Settings for the normal form of a Hopf point: mesh and inverse iteration."""

    shift_offset: float = 1e-10
    """Relative offset of the shift from the eigenvalue estimate, which keeps the shifted matrix regular."""
    found: float = 1e-8
    """Relative distance of shift and eigenvalue below which the iterations converge to rounding error."""
    max_shifts: int = 10
    """Maximum number of shifts of the inverse iteration."""
    accuracy_share: float = 0.1
    """Safety factor on the accuracy: the mesh rule for eigenvalues leaves up to five times the error in c."""
    largest_order: int = 20
    """Largest order of an element; a further element is cheaper than a higher order."""
    max_nodes: int = 2000
    """Maximum number of nodes; Unsolvable for rods that need more."""
    max_arm_nodes: int = 400
    """Maximum number of nodes of an arm, whose matrices are factorised as a whole."""


NORMAL_FORM = NormalFormSettings()
ITERATIONS_PER_SHIFT = 2
"""Inverse iterations with one shift. Two square the distance `NORMAL_FORM.found` to rounding error; one would
leave it in c, beyond the stated error."""


HARMONIC_WAVES = 2
"""Wave number of h20 and h11, which determine c, in units of the wave number of q."""


@dataclass(frozen=True, eq=False, kw_only=True)
class NormalForm:
    """The normal form of one eigenvalue w, Im w > 0, of a rod on a mesh.

    w in 1/tau2, slope = dw/dF, c in 1/(tau2 L^2). q, p, h20 complex and h11 real, of the shape (unknowns,)
    of `form`'s X. At a Hopf point w = i Im w but for the error of the mesh.
    """

    form: MixedForm
    w: complex
    slope: complex
    c: complex
    q: Complex
    p: Complex
    h20: Complex
    h11: Array

    @property
    def F(self) -> float:
        """The force at which w is the eigenvalue, in k3/L^2."""
        return self.form.rod.F

    @property
    def supercritical(self) -> bool:
        """Whether the nonlinearity saturates; cycles are stable if no other mode grows."""
        return self.c.real < 0

    @property
    def amplitude(self) -> float:
        """a of a Hopf point: the largest tip y is |a| sqrt(|F' - F|/|F|) in L.

        a < 0 where the cycles are at F' < F.
        """
        squared = -self.slope.real / self.c.real
        return float(np.sign(squared) * abs(self.F * squared) ** 0.5)

    @property
    def frequency_slope(self) -> float:
        """b of a Hopf point: the frequency of the cycle at F' is Im w + b (F' - F), in 1/tau2."""
        return self.slope.imag - self.c.imag * self.slope.real / self.c.real

    def cycle(self, F: float) -> tuple[float, float]:
        """(squared largest tip y in L^2, frequency in 1/tau2) of the cycle at a force near this one.

        The cycle belongs to the eigenvalue w + slope (F - self.F). With a negative square no cycle exists.
        """
        w = self.w + self.slope * (F - self.F)
        squared = -w.real / self.c.real
        return squared, w.imag + self.c.imag * squared

    def motion(self, amplitude: float, phases: Array) -> Array:
        """X to second order of a cycle at some of its phases, (n,): shape (n, unknowns).

        amplitude: the largest tip y, in L, which is reached at phase 0; a period has 2 pi.
        """
        z = (amplitude * np.exp(1j * phases))[:, None]
        return 2 * (z * self.q).real + (z * z * self.h20).real + amplitude**2 * self.h11


def normal_form(form: MixedForm, guess: complex) -> NormalForm:
    """The normal form of the eigenvalue of (A, M) nearest to a guess, i Im w at a Hopf point.

    Raises Unsolvable where the eigenvalue is real or the iteration finds none.
    """
    transverse, longitudinal = (straight_matrices(form, part) for part in (TRANSVERSE, LONGITUDINAL))
    w, q, p = _modes(transverse, guess)
    # The mode is transverse, so its quadratic fields are longitudinal: the other block is not needed.
    h20 = -longitudinal.factors(2j * w.imag).solve(form.bilinear(q, q))
    h11 = -longitudinal.factors(0).solve(form.bilinear(q, q.conj())).real
    c = np.vdot(p, form.bilinear(q.conj(), h20) / 2 + form.bilinear(q, h11))
    if form.law.nonlinear:
        c += np.vdot(p, form.trilinear(q, q, q.conj())) / 2
    slope = np.vdot(p, form.times_A_F(q))
    return NormalForm(form=form, w=w, slope=complex(slope), c=complex(c), q=q, p=p, h20=h20, h11=h11)


def accurate_normal_form(rod: Rod, w: complex, accuracy: float) -> NormalForm:
    """The normal form of the eigenvalue w, on a mesh that gives c to a relative accuracy.

    Raises Unsolvable where w is no eigenvalue to this accuracy, or no reasonable mesh is fine enough.
    """
    return normal_form_on(elements_for(rod, w, accuracy), rod, w, accuracy)


def elements_for(rod: Rod, w: complex, accuracy: float) -> Elements:
    """Elements that give c of the eigenvalue w to a relative accuracy, as for eigenvalues."""
    accuracy *= NORMAL_FORM.accuracy_share
    waves = HARMONIC_WAVES * wave_number(rod, w)
    if not rod.standard:
        return arm_elements(rod, waves, accuracy, NORMAL_FORM.largest_order)
    resolution = resolution_for(waves, accuracy, NORMAL_FORM.largest_order)
    return of_odd_order(Elements(equal_edges(resolution.elements), resolution.order))


def of_odd_order(elements: Elements) -> Elements:
    """Elements of odd order at least as fine; elements of even order cannot be eliminated one by one."""
    return Elements(elements.edges, elements.order | 1)


def a_third_finer(elements: Elements) -> Elements:
    """Elements with a third more unknowns, of odd order."""
    order = ceil(elements.order * RESOLUTION.refinement)
    if order <= RESOLUTION.largest_order:
        return of_odd_order(Elements(elements.edges, order))
    return of_odd_order(Elements(halved(elements.edges), ceil(RESOLUTION.refinement / 2 * elements.order)))


def normal_form_on(elements: Elements, rod: Rod, w: complex, accuracy: float) -> NormalForm:
    """The normal form of the eigenvalue w on some elements.

    Raises Unsolvable where w is no eigenvalue to a relative accuracy, or the mesh is too fine to be solved.
    """
    nodes = elements.nodes
    limit = NORMAL_FORM.max_nodes if rod.standard else NORMAL_FORM.max_arm_nodes
    if nodes > limit:
        raise Unsolvable(
            f"the normal form at F = {rod.F:g} needs {nodes} mesh nodes, more than the {limit} allowed"
        )
    normal = normal_form(MixedForm(rod, mesh_on(elements.edges, elements.order)), w)
    if not abs(normal.w - w) <= max(accuracy, NORMAL_FORM.found) * abs(w):
        raise Unsolvable(
            f"w = {w:.12g} is no eigenvalue of the mesh at F = {rod.F:g}; the nearest one is {normal.w:.12g}"
        )
    return normal


def _modes(elements: StraightElements | WholeMatrices, guess: complex) -> tuple[complex, Complex, Complex]:
    """(w, q, p) of the eigenvalue nearest to a guess, of the transverse unknowns alone, scaled.

    Two-sided inverse iteration, with the two-sided Rayleigh quotient as the next shift.
    """
    w = complex(guess)
    for _ in range(NORMAL_FORM.max_shifts):
        shift = w * (1 + NORMAL_FORM.shift_offset)
        factors = elements.factors(shift)
        # Odd unknowns are the transverse ones. Longitudinal ones start at 0 and stay there.
        q = p = np.where(elements.form.parity < 0, 1 + 0j, 0)
        for _ in range(ITERATIONS_PER_SHIFT):
            q = factors.solve(elements.times_M(q))
            p = factors.solve(elements.times_M(p), adjoint=True)
            q = q / np.abs(q).max()
            p = p / np.abs(p).max()
        Mq = elements.times_M(q)
        w = complex(np.vdot(p, elements.times_A(q)) / np.vdot(p, Mq))
        if abs(w - shift) <= NORMAL_FORM.found * abs(w):
            break
    else:
        raise Unsolvable(f"inverse iteration finds no eigenvalue near w = {guess:.6g}")
    if not w.imag > 0:
        raise Unsolvable(f"the eigenvalue near w = {guess:.6g} is real: no mode oscillates there")
    # The tip of q is at y = 1/2, so that |z| is the largest tip y of z q + c.c.; <p, M q> = 1 saves every
    # projection on q a denominator.
    scale = 2 * (elements.form.tip_y @ q)
    return w, q / scale, p * scale.conj() / np.vdot(p, Mq).conj()
