"""Modes and growth of arms that vary along their length or are of rubber, against another discretisation."""

from dataclasses import replace

import numpy as np
import pytest
from reference.dense_arm import in_energy_norm, matrices, nodes
from reference.random_arms import random_arm
from scipy.integrate import solve_ivp
from scipy.linalg import expm
from surveyed import RODS, few

from rodsweep.discretization.elements.quadrature import lobatto_points
from rodsweep.discretization.straight.arm_resolution import (
    ARM_RESOLUTION_SETTINGS,
    arm_elements,
    finer_arm_mesh,
)
from rodsweep.discretization.straight.dense_eigenproblem import dense_eigenproblem
from rodsweep.discretization.straight.tip_layer import tip_angle_moment_ratio
from rodsweep.discretization.straight.transverse_mesh import mesh_for, pencil_on
from rodsweep.model.adjoint_tip_conditions import tip_layer_factor
from rodsweep.model.material.profile import Profile
from rodsweep.model.material.rod_material import RodMaterial
from rodsweep.model.rod import Rod
from rodsweep.solve.modes.inverse_iteration import mode_vectors
from rodsweep.solve.modes.leading_modes import ModesRequest, solve_modes
from rodsweep.solve.modes.numerical_abscissa import numerical_abscissa_and_error
from rodsweep.solve.spectrum.status import SpectrumStatus

INF = float("inf")
TIGHT = ModesRequest(mode_count=4, accuracy=1e-10, node_count=65, computes_growth=True)
NEAR = ModesRequest(mode_count=4, accuracy=1e-9, node_count=65, computes_growth=True)
"""Rounding leaves 2e-10 of the bending strain of the steepest of `ARMS`."""
ONES = RodMaterial(profile=Profile((0.0, 1.0), ((1.0,) * 6, (1.0,) * 6)))
STEPS = Profile((0.0, 0.4, 0.4, 1.0), ((1.0,) * 6, (1.0,) * 6, (0.3, 0.5, 0.2, 1.0, 1.5, 0.4), (1.0,) * 6))
SWELLING = RodMaterial("neo_hookean", "swelling")
UNIFORM = [
    {"F": 15.0, "k1": 1e4, "k2": 1e4, "gamma3": 1e-4},
    {"F": 30.0, "k1": 1e4, "k2": 1e4, "gamma3": 1e-4},
    {"F": 15.0, "k1": 1e4, "k2": 200.0, "gamma3": 0.0},
    {"F": 15.0, "k1": INF, "k2": INF, "gamma3": 0.0},
    {"F": -10.0, "k1": 1e4, "k2": 100.0, "gamma3": 1e-2},
]
ARMS = [
    Rod(F=10.0, k1=1e4, k2=1e4, gamma3=1e-4, taper=0.5),
    Rod(F=14.0, k1=500.0, k2=200.0, gamma3=1e-2, taper=0.6, material=SWELLING),
    Rod(F=12.0, k1=1e3, k2=1e3, gamma3=1e-3, material=RodMaterial(profile=STEPS)),
    Rod(F=40.0, k1=1e4, k2=1e4, gamma3=1e-4, taper=2.0, material=RodMaterial("neo_hookean", "fixed", STEPS)),
    Rod(F=25.0, k1=500.0, k2=500.0, gamma3=1e-3, material=SWELLING),
]


def relative(found, exact):
    size = abs(exact).max()
    return abs(found - exact).max() / size if size else abs(found).max()


def numbers(result):
    """All numbers of an outcome but its errors and its meshes, in units of their largest."""
    vectors, growth = result.mode_vectors, result.growth
    return {
        "eigenvalues": result.spectrum.eigenvalues,
        "right": vectors.right_modes,
        "h2": vectors.mode_strains[0],
        "Pi": vectors.mode_strains[1],
        "left": vectors.left_modes,
        "pairing": vectors.pairing,
        "condition": vectors.condition,
        "abscissa": np.array(growth.numerical_abscissa),
        "growth": np.array(growth.transient_growth),
    }


@pytest.mark.parametrize("values", UNIFORM)
@pytest.mark.parametrize("arm", [{"material": ONES}, {"taper": 1 + 1e-12}])
def test_an_arm_that_is_uniform_has_the_modes_of_a_uniform_rod(values, arm):
    exact, found = solve_modes(Rod(**values), TIGHT), solve_modes(Rod(**values, **arm), TIGHT)
    assert found.status == SpectrumStatus.ok
    for name, number in numbers(exact).items():
        assert relative(numbers(found)[name], number) < 1e-10, name


def reference_modes(rod, eigenvalues):
    """(right, left) (y, theta) at the nodes of the reference, (2, modes, nodes), and condition numbers."""
    L, (_, M) = in_energy_norm(rod), matrices(rod)
    w, X = np.linalg.eig(L)
    Z = np.linalg.inv(X).conj().T
    nearest = [int(abs(w - each).argmin()) for each in eigenvalues]
    fields = []
    for V in (X, Z):
        some = (V / np.sqrt(M)[:, None])[:, nearest].T
        y, theta = np.split(some / some[:, [some.shape[1] // 2 - 1]], 2, axis=1)
        fields.append(np.pad(np.stack([y, theta]), ((0, 0), (0, 0), (1, 0))))
    condition = np.linalg.norm(X, axis=0) * np.linalg.norm(Z, axis=0)
    return *fields, condition[nearest]


@pytest.mark.parametrize("rod", ARMS, ids=str)
def test_modes_and_growth_agree_with_another_discretisation(rod):
    result = solve_modes(rod, NEAR)
    assert result.status == SpectrumStatus.ok
    right, left, condition = reference_modes(rod, result.spectrum.eigenvalues)
    assert result.mode_vectors.condition == pytest.approx(condition, rel=1e-7)
    L, growth = in_energy_norm(rod), result.growth
    assert growth.numerical_abscissa == pytest.approx(np.linalg.eigvalsh(L + L.T)[-1] / 2, rel=1e-6)
    if not rod.is_uniform:
        pencil = pencil_on(mesh_for(rod, 12.0, 1e-20))
        vectors = mode_vectors(rod, pencil, result.spectrum.eigenvalues, nodes(rod))
        assert relative(vectors.right_modes, right) < 1e-7
        assert relative(vectors.left_modes, left) < 1e-7
    if np.isfinite(growth.transient_growth):
        assert growth.transient_growth > 1.001
        norms = {x: np.linalg.norm(expm(L * x * growth.transient_time), 2) for x in (0.9, 1.0, 1.1)}
        assert max(norms, key=norms.get) == 1.0
        assert norms[1.0] == pytest.approx(growth.transient_growth, rel=1e-6)
    else:
        assert result.spectrum.unstable_count > 0


@pytest.mark.parametrize("seed", range(max(8, RODS // 10)))
def test_conditions_and_abscissae_of_random_arms(seed):
    """Stiffnesses up to 1e5 times 10 at the ends of short elements cost the reference up to ten digits."""
    rod = random_arm(np.random.default_rng(seed))
    result = solve_modes(rod, ModesRequest(3, 1e-8, 9, computes_growth=True))
    assert result.status == SpectrumStatus.ok
    *_, condition = reference_modes(rod, result.spectrum.eigenvalues)
    assert result.mode_vectors.condition == pytest.approx(condition, rel=1e-5)
    L = in_energy_norm(rod)
    assert result.growth.numerical_abscissa == pytest.approx(np.linalg.eigvalsh(L + L.T)[-1] / 2, rel=1e-4)


@pytest.mark.parametrize("rod", ARMS, ids=str)
def test_strains_and_errors_are_those_of_a_finer_mesh(rod):
    coarse, fine = (
        solve_modes(rod, ModesRequest(4, accuracy, 65, computes_growth=True)) for accuracy in (1e-4, 1e-9)
    )
    assert coarse.status == fine.status == SpectrumStatus.ok
    for name in ("right", "h2", "Pi", "left"):
        errors = abs(numbers(coarse)[name] - numbers(fine)[name]).max(axis=-1)
        sizes = abs(numbers(fine)[name]).max(axis=-1)
        each = errors.max(axis=0) / sizes.max(axis=0) if errors.ndim == 2 else errors / sizes
        assert (each <= 10 * coarse.mode_vectors.mode_error + 1e-9).all(), name
    abscissa = fine.growth.numerical_abscissa
    off = abs(coarse.growth.numerical_abscissa - abscissa)
    assert off <= 10 * coarse.growth.abscissa_error + 1e-9 * abs(abscissa)
    if np.isfinite(fine.growth.transient_growth):
        off = abs(coarse.growth.transient_growth / fine.growth.transient_growth - 1)
        assert off <= coarse.growth.growth_error + 1e-9


def k3_profile(u, k3):
    return Profile(u, tuple((1.0, 1.0, factor, 1.0, 1.0, 1.0) for factor in k3))


STIFF_MIDDLE = Rod(
    F=5.0,
    k1=1e5,
    k2=1e5,
    gamma3=1e-2,
    material=RodMaterial(profile=k3_profile((0.0, 0.4, 0.4, 0.7, 0.7, 1.0), (1, 1, 500, 500, 1, 1))),
)
"""Rounding of its bending stiffness was 1e-9 of its modes."""
STIFF_MIDDLE_FIELDS = [
    (1.2067403451443472, 0.0031631610228151845, 1.3931521946947414),
    (1.4637943265017548, 0.0673272063705114, 1.6404571941865806),
    (-2.9032701460540395, 0.009663574824540482, -3.3310580039775552),
    (-4.253970721191519, -1.3851578617554117, -4.67810593790922),
]
NOTCHED = Rod(
    F=0.3,
    k1=1e4,
    k2=1e3,
    gamma3=1e-3,
    material=RodMaterial(profile=k3_profile((0.0, 0.4, 0.5, 0.6, 1.0), (1, 1, 0.02, 1, 1))),
)
"""Elements of the order 63 that end at the rows left an error of 5e-8."""
NOTCHED_FIELDS = [
    (1.10206943464742, 37.322848152833224, 1.1281747212497206),
    (0.2692902674085496, 250.89900612805258, 0.2504134842297258),
    (-7.460181729778752, 22.456095601612297, -7.499837781704569),
    (-0.05301068984321872, -735.5448765102024, -0.053842188700999494),
]
"""Theta, Pi and Theta+ at u = 1/2 of four modes: Gauss collocation of order 24 of the first-order system of
y, theta, s and m, in extended precision, on 70 elements."""


@pytest.mark.kernel
@pytest.mark.parametrize("rod, exact", [(STIFF_MIDDLE, STIFF_MIDDLE_FIELDS), (NOTCHED, NOTCHED_FIELDS)])
def test_errors_of_modes_are_below_their_estimates_where_the_stiffness_varies(rod, exact):
    result = solve_modes(rod, ModesRequest(4, 1e-10, 65, computes_growth=False))
    assert result.status == SpectrumStatus.ok
    fields = result.mode_vectors.fields[[1, 3, 5]]
    errors = abs(fields[:, :, 32] - np.array(exact).T) / abs(fields).max(axis=2)
    assert (errors.max(axis=0) <= result.mode_vectors.mode_error).all()
    assert result.mode_vectors.condition_error.max() < 1e-13


SHORT_RAMP_FIELDS = [
    (1.2585324595717289, 0.005502522090885092, 1.2565309002067213),
    (3.7775520371796145, 0.23271951376964833, 3.780552619987609),
    (3.9443906473842327, 2.587921919787947, 3.944490128074898),
]
"""Theta, Pi and Theta+ at the 21st of 33 nodes of three modes, as `NOTCHED_FIELDS`, with the order 20."""


@pytest.mark.kernel
def test_large_errors_of_inverse_iteration_are_corrected():
    """Inverse iteration with elements of length 1e-7 leaves errors of 1e-6."""
    ramp = RodMaterial(profile=k3_profile((0.0, 0.5, 0.500001, 1.0), (1, 1, 100, 100)))
    rod = Rod(F=0.1, k1=1e4, k2=1e3, gamma3=1e-3, material=ramp)
    modes = solve_modes(rod, ModesRequest(3, 1e-10, 33, computes_growth=False)).mode_vectors
    errors = abs(modes.fields[[1, 3, 5], :, 20] - np.transpose(SHORT_RAMP_FIELDS))
    assert (errors.max(axis=0) <= 1e-11).all()
    assert modes.mode_error.max() < 5e-5
    assert modes.condition_error.max() < 1e-12


def test_elements_are_halved_only_where_the_stiffness_varies_quickly():
    edges = np.array(mesh_for(NOTCHED, 15.0, 1e-20).edges)
    rows = {0.0, 0.4, 0.5, 0.6, 1.0}
    assert rows < set(edges.tolist())
    assert ((edges >= 0.4) & (edges <= 0.6) | np.isin(edges, [0.0, 1.0])).all()
    for slow in (STIFF_MIDDLE, ARMS[0], ARMS[2]):
        mesh = mesh_for(slow, 15.0, 1e-20)
        assert mesh.edges == arm_elements(slow, 15.0, 1e-20).edges


def test_elements_of_a_short_ramp_are_halved_as_often_as_those_of_a_long_one():
    """Halving does not reduce the rounding of points, a 1e-10th of a ramp of length 1e-6."""
    numbers = []
    for end in (0.501, 0.500001):
        profile = k3_profile((0.0, 0.5, end, 1.0), (1, 1, 0.01, 0.01))
        mesh = mesh_for(replace(NOTCHED, material=RodMaterial(profile=profile)), 15.0, 1e-24)
        numbers.append(mesh.element_count)
    assert 3 < numbers[0] == numbers[1] < 10


def test_elements_are_not_halved_beyond_the_largest_mesh():
    """Where no allowed mesh resolves the stiffness, the error says so."""
    rods = [
        replace(NOTCHED, material=RodMaterial(profile=k3_profile((0.0, 0.48, 0.5, 0.52, 1.0), k3)))
        for k3 in ((1, 1, 1e-3, 1, 1), (1, 1, 1e-7, 1, 1))
    ]
    for rod in rods:
        mesh = mesh_for(rod, 15.0, 1e-20)
        assert mesh.unknown_count <= ARM_RESOLUTION_SETTINGS.max_unknowns_of_halved_elements


def test_the_bending_factor_gives_the_bending_stiffness():
    for rod in (*ARMS, Rod(**UNIFORM[0])):
        form = dense_eigenproblem(rod, pencil_on(mesh_for(rod, 12.0, 1e-20)))
        theta = slice(form.mesh.node_count, 2 * form.mesh.node_count)
        assert relative(-form.bending_factor.T @ form.bending_factor, form.A[theta, theta]) < 1e-14


def test_the_bending_strain_jumps_with_the_stiffness_and_the_moment_does_not():
    rod = ARMS[2]
    result = solve_modes(rod, TIGHT)
    pencil = pencil_on(mesh_for(rod, 12.0, 1e-20))
    beside = np.array([0.4 - 1e-9, 0.4])
    strain = mode_vectors(rod, pencil, result.spectrum.eigenvalues, beside).mode_strains
    assert strain[1, :, 1] == pytest.approx(strain[1, :, 0] / 0.2, rel=1e-6)
    assert strain[0, :, 1] == pytest.approx(strain[0, :, 0] / 0.5, rel=1e-6)


@pytest.mark.parametrize("rod", ARMS[:4], ids=str)
def test_modes_of_different_eigenvalues_are_orthogonal(rod):
    """In the inner product weighted with gamma2 and gamma3 along the arm."""
    result = solve_modes(rod, TIGHT)
    right, left, _ = reference_modes(rod, result.spectrum.eigenvalues)
    _, M = matrices(rod)
    X, Z = (np.concatenate([*field[:, :, 1:]], axis=1) for field in (right, left))
    products = (Z.conj() * M) @ X.T
    assert np.diag(products) == pytest.approx(result.mode_vectors.pairing, rel=1e-6)
    sizes = np.sqrt((abs(Z) ** 2 @ M)[:, None] * (abs(X) ** 2 @ M))
    assert (abs(products - np.diag(np.diag(products))) < 1e-8 * sizes).all()


def test_unshearable_limit_of_an_arm_is_reached_at_first_order():
    arm = {"F": 10.0, "k1": 1e4, "gamma3": 1e-2, "taper": 0.5}
    limit = solve_modes(Rod(k2=INF, **arm), TIGHT)
    assert limit.status == SpectrumStatus.ok
    assert (limit.mode_vectors.mode_strains[0] == 0).all()
    far, near = (solve_modes(Rod(k2=k2, **arm), TIGHT) for k2 in (1e5, 1e6))
    for name, number in numbers(limit).items():
        ratio = abs(numbers(far)[name] - number).max() / abs(numbers(near)[name] - number).max()
        assert ratio == pytest.approx(10, rel=0.02), name


SLAVED = [
    Rod(F=10.0, k1=1e4, k2=200.0, gamma3=0.0, taper=0.5),
    Rod(F=12.0, k1=1e3, k2=1e3, gamma3=0.0, material=RodMaterial(profile=STEPS)),
    Rod(F=1.0, k1=1e4, k2=1e8, gamma3=0.0, taper=0.3),
    Rod(F=-30.0, k1=1e4, k2=12.0, gamma3=0.0, taper=0.9),
]


BASE, TIP = (8.4, 0.34, 2.7, 8.5, 3.4, 2.6), (2.8, 4.1, 0.35, 1.8, 4.0, 6.0)
STIFF_BASE = Profile((0.0, 0.32, 0.32, 1.0), (BASE, BASE, TIP, TIP))
REFINED = [
    Rod(F=-41.6, k1=867.0, k2=583.0, gamma3=0.0173, taper=0.34, material=SWELLING),
    Rod(F=72.0, k1=1350.0, k2=2340.0, gamma3=0.047, taper=0.417, material=RodMaterial(profile=STIFF_BASE)),
]


@pytest.mark.parametrize("rod", REFINED, ids=str)
def test_modes_are_refined_to_the_accuracy(rod):
    """Halved elements of lower order are less accurate than their predecessors; the refinement ended."""
    found = solve_modes(rod, ModesRequest(mode_count=4, accuracy=1e-8, node_count=33, computes_growth=False))
    assert found.status == SpectrumStatus.ok
    assert 0 < max(found.mode_vectors.relative_errors_by_name().values()) < 1e-8
    mesh = finer_arm_mesh(rod, mesh_for(rod, 60.0, 1e-24))
    finer = mode_vectors(rod, pencil_on(mesh), found.spectrum.eigenvalues, lobatto_points(33))
    assert mesh.element_count > found.mode_vectors.resolution.element_count
    assert relative(found.mode_vectors.right_modes, finer.right_modes) < 1e-8
    assert relative(found.mode_vectors.left_modes, finer.left_modes) < 1e-8
    assert relative(found.mode_vectors.condition, finer.condition) < 1e-8


@pytest.mark.long
@pytest.mark.parametrize("rod", few(SLAVED, 2), ids=str)
def test_the_slaved_layer_of_an_arm_solves_its_riccati_equation(rod):
    """T' = c3 - (g nu/c2) T^2, T(0) = 0, from break to break; of T = tan(phi) where T has poles."""

    def slope(u, T):
        at = rod.local_coefficients(np.clip(u, start + 1e-12, end - 1e-12))
        foundation = at.g * at.nu / at.c2
        if poles:
            return at.c3 * np.cos(T) ** 2 - foundation * np.sin(T) ** 2
        return at.c3 - foundation * T**2

    T, breaks, poles = np.zeros(1), rod.material.breaks, rod.F < 0
    for start, end in zip(breaks[:-1], breaks[1:], strict=True):
        T = solve_ivp(slope, (start, end), T, method="Radau", rtol=1e-11, atol=1e-14).y[:, -1]
    assert tip_angle_moment_ratio(rod) == pytest.approx(np.tan(T[0]) if poles else T[0], rel=1e-8)


@pytest.mark.parametrize("k2", [30.0, 1e4, 1e9])
def test_the_slaved_layer_of_a_uniform_arm_is_the_closed_form(k2):
    values = {"F": 15.0, "k1": 1e4, "k2": k2, "gamma3": 0.0}
    assert tip_angle_moment_ratio(Rod(**values, material=ONES)) == pytest.approx(
        tip_layer_factor(Rod(**values)), rel=1e-12
    )


@pytest.mark.parametrize("rod", SLAVED[:2], ids=str)
def test_the_abscissa_of_a_slaved_arm_is_the_largest_quotient(rod):
    """Over y, with theta and theta+ slaved by their own ends on a mesh that resolves the layer."""
    found = solve_modes(rod, TIGHT).growth.numerical_abscissa
    mesh = mesh_for(rod, 160.0, 1e-12)
    assert numerical_abscissa_and_error(rod, pencil_on(mesh))[0] == pytest.approx(found, rel=1e-9)
    form = dense_eigenproblem(rod, pencil_on(mesh))
    A = form.A
    B = form.B
    n = mesh.node_count
    y, slaved = slice(n), slice(n, None)
    L = A[y, y] - A[y, slaved] @ np.linalg.solve(A[slaved, slaved], A[slaved, y])
    assert (B[y] == 1).all()
    w = np.linalg.eigvalsh(L + L.T)[-1] / 2
    assert w == pytest.approx(found, rel=1e-3)
