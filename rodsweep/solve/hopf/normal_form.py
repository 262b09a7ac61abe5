"""Normal form of a Hopf point: amplitude, frequency and motion of the cycles that bifurcate there.

For deviations X from the straight rod the mixed form (`rodsweep.discretization.straight.mixed_form`) is
M dX/dt = A X + B(X, X)/2 + C(X, X, X)/6. With a simple pair of eigenvalues w, conj w of (A, M),
A q = w M q and p^H A = w p^H M, small motions at a force F' near F are, to second order,

    X = z q + conj(z q) + Re(z^2 h20) + |z|^2 h11,      dz/dt = [w + lambda_F (F' - F)] z + c |z|^2 z,
    h20 = (2 i Im w M - A)^-1 B(q, q),                  h11 = -A^-1 B(q, conj q),
    c = p^H [B(conj q, h20) + 2 B(q, h11) + C(q, q, conj q)]/2,           lambda_F = dw/dF = p^H A_F q.

A linear constitutive law has no cubic term. q is scaled to a tip deflection of 1/2, p to p^H M q = 1: with
z = Z exp(i phase) the tip's y is Re z to second order, and |Z| its largest value in L.

The mirror image of a motion is a motion: q and p are transverse, h20 and h11 longitudinal. Away from a Hopf
point, where Re w is not 0, h20 and h11 are the coefficients for a cycle, on which |z| is constant.
"""

from dataclasses import dataclass
from math import ceil

import numpy as np

from ...arrays import Array, Complex
from ...determinant.arm.determinant import eigenfunction_wave_number
from ...discretization.elements.elements import Elements, equal_edges, halved_element_edges
from ...discretization.elements.mesh import mesh_with_edges
from ...discretization.elements.resolution import RESOLUTION_SETTINGS, resolution_for
from ...discretization.straight.arm_resolution import arm_elements
from ...discretization.straight.mixed_form import MixedForm
from ...discretization.straight.straight_matrices import (
    LONGITUDINAL_COMPONENTS,
    TRANSVERSE_COMPONENTS,
    StraightMatrices,
)
from ...model.rod import Rod
from ..unsolvable import Unsolvable


@dataclass(frozen=True, slots=True, kw_only=True)
class NormalFormSettings:
    """Settings for the normal form of a Hopf point: mesh and inverse iteration."""

    relative_shift_offset: float = 1e-10
    """Relative offset of the shift from the eigenvalue estimate; without it the matrix might be singular."""
    converged_relative_shift_distance: float = 1e-8
    """The inverse iteration stops when the relative distance of shift and eigenvalue is at most this number:
    two iterations with this shift reach rounding error."""
    max_shifts: int = 10
    """Maximum number of shifts of the inverse iteration."""
    mesh_accuracy_ratio: float = 0.1
    """The rule that chooses a mesh for an accuracy of an eigenvalue is applied with the requested accuracy of
    the Landau coefficient c, times this factor: the error of c may be five times the error of the
    eigenvalue."""
    max_order: int = 20
    """Largest element order chosen by the mesh rule; an additional element costs less than a higher order."""
    max_nodes: int = 2000
    """Maximum number of nodes for a uniform rod; Unsolvable is raised for a rod that needs more nodes."""
    max_arm_nodes: int = 1000
    """Maximum number of nodes for an arm. On a cone 348 nodes give c within 1e-11, and only a mesh of 504
    nodes shows this."""


NORMAL_FORM_SETTINGS = NormalFormSettings()
ITERATIONS_PER_SHIFT = 2
"""Number of inverse iterations with one shift. After two iterations the error of the mode is about the square
of `NORMAL_FORM_SETTINGS.converged_relative_shift_distance`, below rounding error; after one iteration the
error of the mode would exceed the stated error of the Landau coefficient c."""


HARMONIC_WAVE_NUMBER_RATIO = 2
"""Wave number of the second-order terms h20 and h11 of the normal form, divided by the wave number of the
eigenvector q; h20 and h11 are quadratic in q and determine the Landau coefficient c."""


@dataclass(frozen=True, eq=False)
class NormalForm:
    """Normal form of a rod on a mesh, about the straight rod, for one eigenvalue w with Im w > 0.

    w in 1/tau2, eigenvalue_slope = dw/dF in L^2/(k3 tau2), landau = c in 1/(tau2 L^2). q, p: eigenvector and
    adjoint eigenvector; h20, h11: second-order terms, defined in the module docstring; h11 is real, all
    others are complex. All four are states of `mixed_form`, (unknowns,). transverse_matrices: matrices of the
    transverse components. At a Hopf point w = i Im w up to the error of the mesh.
    """

    mixed_form: MixedForm
    transverse_matrices: StraightMatrices
    w: complex
    eigenvalue_slope: complex
    landau: complex
    q: Complex
    p: Complex
    h20: Complex
    h11: Array

    @property
    def F(self) -> float:
        """The force at which w is the eigenvalue, in k3/L^2."""
        return self.mixed_form.rod.F

    @property
    def is_supercritical(self) -> bool:
        """Whether Re c < 0, c: Landau coefficient. The nonlinearity then limits growth, and the cycles are
        stable if no further mode grows."""
        return self.landau.real < 0

    @property
    def amplitude_coefficient(self) -> float:
        """Amplitude coefficient a, in L, of a Hopf point at the force F: the cycle at a nearby force F' has a
        largest tip y of |a| sqrt(|F' - F|/|F|). a < 0 if the cycles exist at F' < F, otherwise a > 0.
        Infinite if the Landau coefficient c has Re c = 0."""
        with np.errstate(divide="ignore", invalid="ignore"):
            squared_amplitude = -self.eigenvalue_slope.real / np.float64(self.landau.real)
        return float(np.sign(squared_amplitude) * abs(self.F * squared_amplitude) ** 0.5)

    @property
    def frequency_slope(self) -> float:
        """Frequency slope b of a Hopf point at the force F: the cycle at a nearby force F' has the frequency
        Im w + b (F' - F), in 1/tau2. Infinite if the Landau coefficient c has Re c = 0."""
        with np.errstate(divide="ignore", invalid="ignore"):
            shift = self.landau.imag * self.eigenvalue_slope.real / np.float64(self.landau.real)
        return float(self.eigenvalue_slope.imag - shift)

    def squared_y_and_frequency(self, F: float) -> tuple[float, float]:
        """(squared largest tip y in L^2, frequency in 1/tau2) of the cycle at a force F near `self.F`. The
        eigenvalue at F is taken as w + eigenvalue_slope (F - self.F). If the square is negative, no cycle
        exists."""
        w = self.w + self.eigenvalue_slope * (F - self.F)
        squared_y = -w.real / self.landau.real
        return squared_y, w.imag + self.landau.imag * squared_y

    def cycle_states(self, amplitude: float, phases: Array) -> Array:
        """State X of a cycle, to second order in `amplitude`, at `phases`, (n,), in rad: shape (n, unknowns).
        amplitude: the largest tip y, in L, which is reached at phase 0."""
        z = (amplitude * np.exp(1j * phases))[:, None]
        return 2 * (z * self.q).real + (z * z * self.h20).real + amplitude**2 * self.h11


def normal_form(form: MixedForm, guess: complex) -> NormalForm:
    """Normal form of the eigenvalue of (A, M) nearest to `guess`. Raises Unsolvable if the eigenvalue is real
    or the inverse iteration does not converge."""
    transverse, longitudinal = (
        StraightMatrices(form, part) for part in (TRANSVERSE_COMPONENTS, LONGITUDINAL_COMPONENTS)
    )
    w, q, p = _eigenvalue_and_modes(transverse, guess)
    # The mode is transverse, so its quadratic fields are longitudinal: the opposite blocks are not needed.
    h20 = -longitudinal.lu_factors(2j * w.imag).solve(form.bilinear_map(q, q))
    # Everything is real at the shift 0, but the solver is complex.
    h11 = -longitudinal.lu_factors(0).solve(form.bilinear_map(q, q.conj())).real
    c = np.vdot(p, form.bilinear_map(q.conj(), h20) / 2 + form.bilinear_map(q, h11))
    if form.law_derivatives.is_nonlinear:
        c += np.vdot(p, form.trilinear_map(q, q, q.conj())) / 2
    slope = complex(np.vdot(p, form.times_force_derivative_of_A(q)))
    return NormalForm(form, transverse, w, slope, complex(c), q=q, p=p, h20=h20, h11=h11)


def normal_form_by_mesh_rule(rod: Rod, w: complex, accuracy: float) -> NormalForm:
    """Normal form of the eigenvalue w of `rod`, on a mesh that gives the Landau coefficient c to the relative
    accuracy `accuracy`. Raises Unsolvable for the reasons of `normal_form_on`."""
    return normal_form_on(elements_for_landau_coefficient(rod, w, accuracy), rod, w, accuracy)


def elements_for_landau_coefficient(rod: Rod, w: complex, accuracy: float) -> Elements:
    """Elements on which the Landau coefficient c at the eigenvalue w has the relative accuracy `accuracy`, by
    the mesh rule for eigenvalues."""
    accuracy *= NORMAL_FORM_SETTINGS.mesh_accuracy_ratio
    wave_number_of_harmonics = HARMONIC_WAVE_NUMBER_RATIO * eigenfunction_wave_number(rod, w)
    if not rod.is_uniform_and_linear:
        return arm_elements(rod, wave_number_of_harmonics, accuracy, NORMAL_FORM_SETTINGS.max_order)
    resolution = resolution_for(wave_number_of_harmonics, accuracy, NORMAL_FORM_SETTINGS.max_order)
    return with_odd_order(Elements(equal_edges(resolution.element_count), resolution.order))


def with_odd_order(elements: Elements) -> Elements:
    """The same elements with an odd order, increased by 1 if even: the mesh rule was measured with odd
    orders."""
    return Elements(elements.edges, elements.order | 1)


def elements_with_third_more_unknowns(elements: Elements) -> Elements:
    """Elements with about a third more unknowns than `elements`, of odd order."""
    order = ceil(elements.order * RESOLUTION_SETTINGS.finer_over_current_unknowns)
    if order <= RESOLUTION_SETTINGS.max_order:
        return with_odd_order(Elements(elements.edges, order))
    return with_odd_order(
        Elements(
            halved_element_edges(elements.edges),
            ceil(RESOLUTION_SETTINGS.finer_over_current_unknowns / 2 * elements.order),
        )
    )


def normal_form_on(elements: Elements, rod: Rod, w: complex, accuracy: float) -> NormalForm:
    """Normal form of the eigenvalue w of `rod` on the mesh `elements`.

    Raises Unsolvable if the mesh has too many nodes, if its nearest eigenvalue differs from w by more than
    the relative accuracy `accuracy` (at least `NORMAL_FORM_SETTINGS.converged_relative_shift_distance`), or
    for the reasons of `normal_form`.
    """
    node_count = elements.node_count
    max_node_count = (
        NORMAL_FORM_SETTINGS.max_nodes if rod.is_uniform_and_linear else NORMAL_FORM_SETTINGS.max_arm_nodes
    )
    if node_count > max_node_count:
        raise Unsolvable(
            f"the normal form at F = {rod.F:g} needs {node_count} mesh nodes, more than the "
            f"{max_node_count} allowed"
        )
    normal = normal_form(MixedForm(rod, mesh_with_edges(elements.edges, elements.order)), w)
    if not abs(normal.w - w) <= max(accuracy, NORMAL_FORM_SETTINGS.converged_relative_shift_distance) * abs(
        w
    ):
        raise Unsolvable(
            f"the mesh of the normal form misses the eigenvalue w = {w:.12g} of the rod at F = {rod.F:g}; "
            f"the nearest eigenvalue of the mesh is {normal.w:.12g}"
        )
    return normal


def _eigenvalue_and_modes(matrices: StraightMatrices, guess: complex) -> tuple[complex, Complex, Complex]:
    """(w, q, p): eigenvalue nearest to `guess`, and its transverse eigenvector q and adjoint eigenvector p,
    scaled as in the module docstring. Two-sided inverse iteration, shifted by the Rayleigh quotient. Raises
    Unsolvable."""
    w = complex(guess)
    for _ in range(NORMAL_FORM_SETTINGS.max_shifts):
        if not np.isfinite(w):  # a factorisation would raise an error
            continue
        # At the eigenvalue itself the matrix would be singular.
        shift = w * (1 + NORMAL_FORM_SETTINGS.relative_shift_offset)
        factors = matrices.lu_factors(shift)
        # Odd unknowns are transverse. The longitudinal unknowns start at 0 and remain 0.
        q: Complex = np.where(matrices.form.reflection_signs < 0, 1 + 0j, 0)
        p = q
        for _ in range(ITERATIONS_PER_SHIFT):
            q = factors.solve(matrices.times_M(q))
            p = factors.solve(matrices.times_M(p), adjoint=True)
            q = q / np.abs(q).max()
            p = p / np.abs(p).max()
        Mq = matrices.times_M(q)
        w = complex(np.vdot(p, matrices.times_A(q)) / np.vdot(p, Mq))
        if abs(w - shift) <= NORMAL_FORM_SETTINGS.converged_relative_shift_distance * abs(w):
            break
    else:
        raise Unsolvable(f"inverse iteration finds no eigenvalue near w = {guess:.6g}")
    if not w.imag > 0:
        raise Unsolvable(f"the eigenvalue near w = {guess:.6g} is real: no mode oscillates there")
    # The tip of q is at y = 1/2, so that |z| is the largest tip y of z q + c.c.; with <p, M q> = 1, a
    # projection on q needs no denominator.
    scale = 2 * (matrices.form.tip_y_functional @ q)
    return w, q / scale, p * scale.conj() / np.vdot(p, Mq).conj()
