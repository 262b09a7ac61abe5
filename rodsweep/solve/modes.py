"""The leading modes of one rod, their adjoints, and what non-normality makes of them.

Eigenvalues come from `rodsweep.solve.spectrum`, certified and with their own error estimate. Each is the
shift of an inverse iteration on a dense mesh, with the pencil for the right and its transpose for the
left vector. All of it is done on two meshes, whose difference is the error estimate of the coarser one;
the numbers given are the finer one's.

Normalisation, stated once: right modes have Y(1) = 1, and so do left modes, Y+(1) = 1, which makes both
equal at F = 0, where L is self-adjoint. `pairing` has the product (psi_n, xi_n) that this leaves: the share
of mode n in a state xi is (psi_n, xi)/(psi_n, xi_n). A left mode belongs to the eigenvalue w* of the
adjoint (Appendix B), so that (psi_m, xi_n) = int Y+_m* Y_n + gamma3 Theta+_m* Theta_n = 0 for m != n.
"""

import time
from dataclasses import dataclass, replace
from math import inf, nan

import numpy as np
from numpy.typing import NDArray

from ..discretization.basis import differentiation, interpolation
from ..discretization.pencil import SHEAR_WEIGHT, Pencil, assemble
from ..discretization.quadrature import gauss, gauss_lobatto, lobatto_points
from ..discretization.resolution import Resolution, finer, mesh_accuracy, resolution_for
from ..model.determinant import newton_correction
from ..model.rod import Rod
from .growth import Growth, dense_operator, numerical_abscissa, transient_growth
from .spectrum import NO_TIP, Spectrum, SpectrumRequest, solve_spectrum
from .status import Status

Complex = NDArray[np.complex128]

ITERATIONS = 4
"""Inverse iterations: with the eigenvalue known two suffice but next to a double one."""
ORDER_STEP = 4
"""How much finer the second mesh is; two orders of magnitude in the vectors."""
MOST_MESHES = 4
MOST_DENSE_UNKNOWNS = 1500
"""Unknowns beyond which dense linear algebra takes seconds."""
GROWTH_WAVE_NUMBER = 24.0
"""Wave number of the eighth mode at rest: the growth at short times needs more than the wanted modes."""
FINEST_MESH_ACCURACY = 1e-24
CONJUGATE = 1e-12
"""Relative distance below which two neighbouring eigenvalues are one pair."""
SURELY = 4.0
"""Error estimates that a growth rate must be from 0 to be called positive."""


@dataclass(frozen=True, slots=True)
class ModesRequest:
    """What is asked: the number of modes, a relative accuracy, Lobatto nodes, and the extras."""

    modes: int
    accuracy: float
    nodes: int
    growth: bool
    """Whether the numerical abscissa and the transient growth are wanted."""
    certify: bool = True


@dataclass(frozen=True, slots=True)
class Modes:
    """The leading modes of one rod, in the order that `rodsweep.model` states.

    eigenvalues, error_estimate: complex and real, shape (modes,), in 1/tau2; unstable_count, certified:
    as in `rodsweep.solve.spectrum.Spectrum`; elements, order: of the mesh of the vectors.
    right: (Y, Theta) with Y(1) = 1, left: (Y+, Theta+) with Y+(1) = 1, in L and 1 for a tip deflection of L;
    deformation: (h2, Pi) = (Y' - nu Theta, Theta') of the right modes (Sec. V), h2 = c2 s being exactly
    0 in an unshearable rod; complex, shape (2, modes, nodes), NaN where a tip does not move.
    mode_error: largest error of Y, Theta, h2, Pi, Y+ and Theta+, each in units of its largest value.
    pairing: (psi_n, xi_n) in the Gamma inner product, complex, shape (modes,).
    condition: |psi| |xi|/|(psi, xi)| >= 1, shape (modes,): how much farther than its size a perturbation of
    L, in the Gamma norm, moves the eigenvalue; inf at the onset F*. With gamma3 = 0 theta follows
    y at once, is no part of the state, and the norm is that of y. condition_error: relative.
    numerical_abscissa: sup Re (xi, L xi)/(xi, xi), the growth rate at t = 0+, in 1/tau2; abscissa_error.
    transient_growth: sup_t |exp(L t)| in the Gamma norm, transient_time: when, in tau2: 1 at 0 where the
    abscissa is <= 0, inf at inf for an unstable rod, NaN where stability is undecided or growth
    was not asked for; growth_error: relative. The time is as accurate as a flat maximum allows.
    """

    status: Status
    eigenvalues: Complex
    error_estimate: NDArray[np.float64]
    unstable_count: int
    certified: bool
    elements: int
    order: int
    seconds: float
    right: Complex
    deformation: Complex
    left: Complex
    mode_error: NDArray[np.float64]
    pairing: Complex
    condition: NDArray[np.float64]
    condition_error: NDArray[np.float64]
    numerical_abscissa: float = nan
    abscissa_error: float = nan
    transient_growth: float = nan
    transient_time: float = nan
    growth_error: float = nan
    message: str = ""


@dataclass(frozen=True, slots=True)
class Shapes:
    """The modes on one mesh: arrays as in `Modes`."""

    pencil: Pencil
    right: Complex
    deformation: Complex
    left: Complex
    pairing: Complex
    condition: NDArray[np.float64]


def solve_modes(rod: Rod, request: ModesRequest) -> Modes:
    """The leading `request.modes` modes of `rod`; failures are a status, never an exception."""
    started = time.perf_counter()
    spectrum = solve_spectrum(rod, SpectrumRequest(request.modes, request.accuracy, request.certify))
    outcome = _without_vectors(spectrum, request)
    if np.isfinite(spectrum.eigenvalues).all():
        try:
            with np.errstate(all="ignore"):
                outcome = _solve(rod, request, outcome)
        except (np.linalg.LinAlgError, ArithmeticError, MemoryError) as error:
            outcome = replace(outcome, status=Status.failed, message=str(error) or type(error).__name__)
    return replace(outcome, seconds=time.perf_counter() - started)


def _without_vectors(spectrum: Spectrum, request: ModesRequest) -> Modes:
    """The outcome as far as the spectrum goes."""
    shapes = np.full((2, request.modes, request.nodes), np.nan + 0j)
    numbers = np.full(request.modes, np.nan)
    return Modes(
        status=spectrum.status,
        eigenvalues=spectrum.eigenvalues,
        error_estimate=spectrum.error_estimate,
        unstable_count=spectrum.unstable_count,
        certified=spectrum.certified,
        elements=spectrum.elements,
        order=spectrum.order,
        seconds=0.0,
        right=shapes,
        deformation=shapes,
        left=shapes,
        mode_error=numbers,
        pairing=numbers + 0j,
        condition=numbers,
        condition_error=numbers,
        message=spectrum.message,
    )


def _solve(rod: Rod, request: ModesRequest, outcome: Modes) -> Modes:
    points = lobatto_points(request.nodes)
    mesh = _first_mesh(rod, request, outcome.eigenvalues)
    coarse = mode_shapes(rod, assemble(mesh.elements, mesh.order), outcome.eigenvalues, points)
    best: Modes | None = None
    least, blame = inf, ""
    for _ in range(MOST_MESHES):
        mesh = Resolution(mesh.elements, mesh.order + ORDER_STEP) if best is None else finer(mesh)
        if mesh.unknowns > MOST_DENSE_UNKNOWNS:
            break
        fine = mode_shapes(rod, assemble(mesh.elements, mesh.order), outcome.eigenvalues, points)
        result = _compared(coarse, fine, outcome)
        if request.growth:
            result = _with_growth(rod, (coarse.pencil, fine.pencil), request.accuracy, result)
        culprit, error = _largest_error(result, request.growth)
        improved = error < least / 2
        if best is None or error < least:
            best, least, blame = result, error, f"the error of the {culprit} is {error:.0e}"
        if least <= request.accuracy or not improved:
            break
        coarse = fine
    if best is None:
        return replace(outcome, status=Status.failed, message="no dense mesh resolves the modes")
    if least <= request.accuracy:
        return best
    return replace(best, status=Status.accuracy_not_reached, message=blame)


def _first_mesh(rod: Rod, request: ModesRequest, eigenvalues: Complex) -> Resolution:
    """The coarser mesh of the first pair: fine enough for the vectors, and for the growth."""
    wave = max(newton_correction(complex(w), rod.coefficients)[2] for w in eigenvalues)
    mesh = resolution_for(wave, max(mesh_accuracy(request.accuracy, True), FINEST_MESH_ACCURACY))
    if request.growth:
        other = resolution_for(max(wave, GROWTH_WAVE_NUMBER), request.accuracy)
        mesh = max(mesh, other, key=lambda choice: choice.unknowns)
    return mesh


def mode_shapes(rod: Rod, pencil: Pencil, eigenvalues: Complex, points: NDArray[np.float64]) -> Shapes:
    """The modes of known eigenvalues on one mesh, at `points` in [0, 1]."""
    A, B = dense_operator(rod, pencil)
    m = len(eigenvalues)
    X, Z = np.empty((pencil.unknowns, m), complex), np.empty((pencil.unknowns, m), complex)
    for i, w in enumerate(eigenvalues):
        if i and abs(w - eigenvalues[i - 1].conj()) <= CONJUGATE * abs(w) and w.imag < 0:
            X[:, i], Z[:, i] = X[:, i - 1].conj(), Z[:, i - 1].conj()
            continue
        X[:, i], Z[:, i] = _null_vectors(A, B, complex(w))
    scale, left_scale = _tip_scale(rod, pencil, X), _tip_scale(rod, pencil, Z)
    X, Z = X * scale, Z * left_scale
    evaluation = pencil.evaluation(points)
    y, theta = pencil.fields(X, rod)
    right = np.stack([(evaluation @ y).T, (evaluation @ theta).T])
    adjoint = np.stack([(evaluation @ field).T for field in pencil.fields(Z.conj(), rod)])
    deformation = np.stack([rod.c2 * shear_force(pencil, X, points).T, slope(pencil, theta, points).T])
    pairing = (B[:, None] * Z * X).sum(axis=0)
    norms = [np.sqrt((B[:, None] * np.abs(V) ** 2).sum(axis=0)) for V in (X, Z)]
    return Shapes(pencil, right, deformation, adjoint, pairing, norms[0] * norms[1] / np.abs(pairing))


def _null_vectors(A: NDArray, B: NDArray, w: complex) -> tuple[NDArray, NDArray]:
    """The right and the left vector of the eigenvalue w, of largest entry 1; real where w is."""
    inverse = np.linalg.inv(A - np.diag((w if w.imag else w.real) * B))
    x = z = np.ones(len(B))
    for _ in range(ITERATIONS):
        x, z = inverse @ (B * x), inverse.T @ (B * z)
        x, z = x / np.abs(x).max(), z / np.abs(z).max()
    return x, z


def _tip_scale(rod: Rod, pencil: Pencil, vectors: Complex) -> Complex:
    """What makes y(1) = 1 of each vector; NaN where the tip does not move."""
    y, theta = pencil.fields(vectors, rod)
    size = np.maximum(np.abs(y).max(axis=0), np.abs(theta).max(axis=0))
    return np.where(np.abs(y[-1]) > NO_TIP * size, 1 / y[-1], np.nan)


def shear_force(pencil: Pencil, vectors: Complex, points: NDArray[np.float64]) -> Complex:
    """s of the vectors at `points`, from its own unknowns at the Gauss nodes; shape (points, k)."""
    nodes, weights = gauss(pencil.order)
    mass = np.tile(weights / (2 * pencil.elements), pencil.elements) * SHEAR_WEIGHT**2
    values = vectors[2 * pencil.nodes :] / np.sqrt(mass)[:, None]
    result = np.empty((len(points), vectors.shape[1]), complex)
    element = np.minimum((points * pencil.elements).astype(int), pencil.elements - 1)
    for e in np.unique(element):
        local = 2 * (points[element == e] * pencil.elements - e) - 1
        result[element == e] = interpolation(nodes, local) @ values[e * pencil.order : (e + 1) * pencil.order]
    return result


def slope(pencil: Pencil, values: Complex, points: NDArray[np.float64]) -> Complex:
    """The derivative at `points` of fields given at all nodes, shape (nodes + 1, k); shape (points, k)."""
    nodes, _ = gauss_lobatto(pencil.order)
    derivative = 2 * pencil.elements * differentiation(nodes)
    result = np.empty((len(points), values.shape[1]), complex)
    element = np.minimum((points * pencil.elements).astype(int), pencil.elements - 1)
    for e in np.unique(element):
        local = 2 * (points[element == e] * pencil.elements - e) - 1
        here = values[e * pencil.order : (e + 1) * pencil.order + 1]
        result[element == e] = interpolation(nodes, local) @ (derivative @ here)
    return result


def _compared(coarse: Shapes, fine: Shapes, outcome: Modes) -> Modes:
    """The finer mesh's modes, and how far the coarser one's are from them."""
    error = np.zeros(len(fine.condition))
    pairs = ((coarse.right, fine.right), (coarse.deformation, fine.deformation), (coarse.left, fine.left))
    for old, new in pairs:
        size = np.abs(new).max(axis=2)
        change = np.abs(new - old).max(axis=2)
        relative = np.where(size > 0, change / np.where(size > 0, size, 1.0), change)
        error = np.maximum(error, relative.max(axis=0))
    return replace(
        outcome,
        elements=fine.pencil.elements,
        order=fine.pencil.order,
        right=fine.right,
        deformation=fine.deformation,
        left=fine.left,
        mode_error=error,
        pairing=fine.pairing,
        condition=fine.condition,
        condition_error=np.abs(coarse.condition / fine.condition - 1),
    )


def _with_growth(rod: Rod, pencils: tuple[Pencil, Pencil], accuracy: float, result: Modes) -> Modes:
    """The outcome with its numerical abscissa and its transient growth."""
    first, second = (numerical_abscissa(rod, pencil) for pencil in pencils)
    w, error = result.eigenvalues.real, result.error_estimate
    if (w > SURELY * error).any() or result.unstable_count > 0:
        growth = Growth(inf, inf, 0.0)
    elif result.status == Status.undecided:
        growth = Growth(nan, nan, nan)
    else:
        growth = transient_growth(rod, pencils, second, accuracy)
    return replace(
        result,
        numerical_abscissa=second,
        abscissa_error=abs(second - first),
        transient_growth=growth.largest,
        transient_time=growth.time,
        growth_error=growth.error,
    )


def _largest_error(result: Modes, growth: bool) -> tuple[str, float]:
    """(whose, how large): the largest relative error; the abscissa next to the leading eigenvalue."""
    errors = {"modes": result.mode_error.max(), "condition numbers": result.condition_error.max()}
    if growth:
        scale = max(abs(result.numerical_abscissa), abs(result.eigenvalues[0]))
        errors["numerical abscissa"] = result.abscissa_error / scale
        if result.status != Status.undecided:
            errors["transient growth"] = result.growth_error
    known = {name: inf if np.isnan(error) else float(error) for name, error in errors.items()}
    return max(known.items(), key=lambda item: item[1])
