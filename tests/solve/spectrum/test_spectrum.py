"""The leading eigenvalues of one rod against the reference, and how points end that cannot be ok."""

import re
from dataclasses import replace

import mpmath as mp
import numpy as np
import pytest
from hard.exact import sensitivity
from reference import determinant as reference

from rodsweep.discretization.elements.quadrature import lobatto_points
from rodsweep.discretization.elements.resolution import Resolution
from rodsweep.model.dispersion import largest_growth_and_wave_number
from rodsweep.model.rod import Rod
from rodsweep.solve.backend.petsc import PETSc
from rodsweep.solve.spectrum import krylov_schur_on_two_meshes, search
from rodsweep.solve.spectrum import problem as problem_module
from rodsweep.solve.spectrum.krylov_schur import uniform_solver
from rodsweep.solve.spectrum.krylov_schur_on_two_meshes import solve_on_two_meshes
from rodsweep.solve.spectrum.search import SpectrumRequest, solve_spectrum
from rodsweep.solve.spectrum.shift_invert import KRYLOV_SETTINGS
from rodsweep.solve.spectrum.status import SpectrumStatus

TIGHT = SpectrumRequest(mode_count=4, accuracy=1e-12, certify=True)

pytestmark = pytest.mark.kernel


def rod_of(point):
    return Rod(**{name: float(point[name]) for name in ("F", "k1", "k2", "gamma3")})


def leading(point, modes):
    return np.array([complex(float(re), float(im)) for re, im in point["eigenvalues"]])[:modes]


def test_pushed_rods_to_twelve_digits_none_missed_none_invented(reference_spectra):
    """All reference rods with F >= 0: every leading eigenvalue to 1e-12, every count as proved."""
    for point in reference_spectra:
        rod = rod_of(point)
        if rod.F < 0:
            continue
        result = solve_spectrum(rod, TIGHT)
        exact = leading(point, 4)
        error = np.abs(result.eigenvalues - exact) / np.abs(exact)
        assert (result.status, result.certified) == (SpectrumStatus.ok, True), rod
        assert result.unstable_count == point["unstable"], rod
        assert error.max() < 1e-12, rod


def test_pulled_rods_lose_no_digit(reference_spectra):
    """F < 0 makes the first eigenvalue exponentially small: the mesh loses it in rounding, D does not."""
    for point in reference_spectra:
        rod = rod_of(point)
        if rod.F >= 0:
            continue
        result = solve_spectrum(rod, TIGHT)
        # A pull beyond the shear stiffness without rotational drag has no a-priori bound.
        assert result.status in (
            {SpectrumStatus.ok} if rod.g > 0 or rod.gamma3 > 0 else {SpectrumStatus.not_certified}
        ), rod
        exact = leading(point, 4)
        assert (np.abs(result.eigenvalues - exact) < 1e-13 * np.abs(exact)).all(), rod
        assert result.unstable_count == (point["unstable"] if result.certified else -1), rod


def by_luck(w, rod):
    """Errors up to here may be small by luck, whatever the estimate of what rounding can do: in 1/tau2.

    D is rounded as if the force were, by half a unit in its last place or more. What that does to an
    eigenvalue is a few units in its own last place, and a hundred times as much next to a double one.
    """
    half_a_unit = np.finfo(float).eps / 2
    return abs(w) * max(4e-15, half_a_unit * sensitivity(complex(w), (rod.F, rod.k1, rod.k2, rod.gamma3)))


@pytest.mark.long
def test_error_estimate_is_the_error_within_a_factor_of_ten(reference_spectra):
    """For a quarter of the eigenvalues: an error may be small by luck, so each is compared with rounding."""
    ratios = []
    for point in reference_spectra:
        rod = rod_of(point)
        result = solve_spectrum(rod, SpectrumRequest(4, 1e-5, True))
        exact = [mp.mpc(*parts) for parts in point["eigenvalues"][:4]]
        for w, root, estimate in zip(
            map(complex, result.eigenvalues), exact, result.error_estimate, strict=True
        ):
            error = float(abs(w - root))
            assert error <= estimate, point
            assert estimate <= 20 * by_luck(w, rod), point
            if estimate > 4e-14 * abs(w):
                ratios.append(error / estimate)
    assert len(ratios) > 3
    assert np.quantile(ratios, 0.75) > 0.1, ratios


def test_few_unknowns_suffice_for_every_accuracy(reference_spectra):
    """The mesh finds the eigenvalues, D gives their digits: 36 unknowns on the paper's rods."""
    rods = [point for point in reference_spectra if point["group"].startswith("c")][::4]
    for point in rods:
        result = solve_spectrum(rod_of(point), TIGHT)
        assert result.status == SpectrumStatus.ok
        exact = leading(point, 4)
        assert (np.abs(result.eigenvalues - exact) / np.abs(exact)).max() < 1e-13
        assert 3 * result.elements * result.order <= 36


def test_order_is_descending_real_part_positive_frequency_first(reference_spectra):
    for point in reference_spectra[::10]:
        w = solve_spectrum(rod_of(point), SpectrumRequest(6, 1e-8, True)).eigenvalues
        pairs = [(-value.real, -value.imag) for value in w]
        assert np.isfinite(w).all()
        assert pairs == sorted(pairs)
        for i, value in enumerate(w[:-1]):
            if value.imag > 0:
                assert w[i + 1] == value.conjugate()


def test_rod_without_force_has_real_negative_eigenvalues():
    for k1, k2, gamma3 in ((1e4, 1e4, 1e-4), (100.0, 20.0, 1.0), (np.inf, np.inf, 0.0), (50.0, 5.0, 0.0)):
        result = solve_spectrum(Rod(F=0.0, k1=k1, k2=k2, gamma3=gamma3), TIGHT)
        assert result.status == SpectrumStatus.ok
        assert (result.eigenvalues.imag == 0).all()
        assert (result.eigenvalues.real < 0).all()


@pytest.mark.parametrize(
    ("F", "k1", "k2", "gamma3"), [(37.6559805452711, 1e4, 1e4, 1e-4), (155.600159298791, 200.0, 1e4, 1e-4)]
)
def test_rod_at_a_hopf_point_is_undecided(F, k1, k2, gamma3):
    result = solve_spectrum(Rod(F=F, k1=k1, k2=k2, gamma3=gamma3), TIGHT)
    assert result.status == SpectrumStatus.undecided
    assert result.unstable_count == -1
    assert not result.certified
    for nudge, count in ((-1e-9, 0), (1e-9, 2)) if k1 > 1e3 else ((1e-9, 0), (-1e-9, 2)):
        beside = solve_spectrum(Rod(F=F * (1 + nudge), k1=k1, k2=k2, gamma3=gamma3), TIGHT)
        assert (beside.status, beside.unstable_count, beside.certified) == (SpectrumStatus.ok, count, True)


def test_exceptional_point_says_that_digits_are_lost():
    """At the onset F* two eigenvalues coincide and half of the digits are gone; the estimate knows."""
    result = solve_spectrum(Rod(F=20.0080206921031, k1=1e4, k2=1e4, gamma3=1e-4), TIGHT)
    assert result.status == SpectrumStatus.accuracy_not_reached
    relative = result.error_estimate / np.abs(result.eigenvalues)
    assert 1e-9 < relative[:2].max() < 1e-6
    assert relative[2:].max() < 1e-12
    assert result.unstable_count == 0
    assert result.certified


def test_strong_pull_keeps_its_digits():
    """F = -1000 makes the first eigenvalue smaller than the rounding of the pencil by far.

    The estimate is a bound of what rounding could do to D, which is worse there than what it does.
    """
    rod = Rod(F=-1000.0, k1=1e4, k2=1e4, gamma3=1e-4)
    result = solve_spectrum(rod, SpectrumRequest(4, 1e-8, True))
    assert (result.status, result.unstable_count, result.certified) == (SpectrumStatus.ok, 0, True)
    with mp.workdps(60):
        for w in result.eigenvalues:
            exact = reference.refine(mp.mpc(complex(w)), rod.F, rod.k1, rod.k2, rod.gamma3)
            assert abs(exact - complex(w)) < 1e-13 * abs(exact)
    assert -1.2e-9 < result.eigenvalues[0].real < -1.1e-9


def test_pull_without_a_certificate_says_what_the_mesh_could_not_find():
    result = solve_spectrum(Rod(F=-1000.0, k1=1e4, k2=1e4, gamma3=1e-4), SpectrumRequest(4, 1e-8, False))
    assert result.status in (SpectrumStatus.ok, SpectrumStatus.accuracy_not_reached)
    assert result.eigenvalues[0] == pytest.approx(-1.126566e-09, rel=1e-6)


class Forgetful:
    """An eigensolver that loses the rightmost pair unless it is asked for many eigenvalues."""

    def __init__(self, solver, remembers_from):
        self.solver, self.remembers_from = solver, remembers_from

    def __getattr__(self, name):
        return getattr(self.solver, name)

    def solve(self, rod, shift, requested, tight=False):
        w = self.solver.solve(rod, shift, requested, tight)
        if requested >= self.remembers_from:
            return w
        return w[w.real < w.real.max() - 1e-6 * abs(w.real.max())]


@pytest.mark.parametrize(
    ("remembers_from", "status"), [(9, SpectrumStatus.ok), (10**9, SpectrumStatus.modes_missing)]
)
def test_lost_mode_is_found_again_or_the_numbers_are_withheld(monkeypatch, remembers_from, status):
    rod = Rod(F=50.0, k1=1e4, k2=1e4, gamma3=1e-4)
    whole = solve_spectrum(rod, TIGHT)
    real = problem_module.uniform_solver
    monkeypatch.setattr(
        problem_module, "uniform_solver", lambda resolution: Forgetful(real(resolution), remembers_from)
    )
    result = solve_spectrum(rod, TIGHT)
    assert result.status == status
    if status == SpectrumStatus.ok:
        assert np.abs(result.eigenvalues - whole.eigenvalues).max() < 1e-12 * np.abs(whole.eigenvalues).max()
        assert result.unstable_count == 2
    else:
        assert np.isnan(result.eigenvalues).all()
        assert not result.certified


def test_number_of_modes_asked_for_does_not_make_a_point_fail():
    """Asked for one or two of this rod, SLEPc once made a Krylov space of rounding, and LAPACK gave up."""
    rod = Rod(F=235.44686855743151, k1=np.inf, k2=np.inf, gamma3=0.0002066784352422915)
    results = [solve_spectrum(rod, SpectrumRequest(modes, 1e-10, True)) for modes in range(1, 9)]
    assert {(result.status, result.unstable_count) for result in results} == {(SpectrumStatus.ok, 4)}
    for result in results:
        assert np.allclose(result.eigenvalues, results[-1].eigenvalues[: len(result.eigenvalues)], rtol=1e-12)


@pytest.mark.parametrize("gamma3", [0.0, 1e-3])
def test_mesh_never_gives_more_eigenvalues_than_it_has(gamma3):
    """k2 = inf: two thirds of the pencil's eigenvalues are infinite, and no space is left for them."""
    rng = np.random.default_rng(1)
    for nodes in range(6, 20):
        for requested in range(1, nodes // 2 + 1):
            rod = Rod(F=float(10 ** rng.uniform(0, 2.5)), k1=np.inf, k2=np.inf, gamma3=gamma3)
            solver = uniform_solver(Resolution(1, nodes))
            found = solver.solve(
                rod, 1.05 * largest_growth_and_wave_number(rod)[0], requested, to_rounding=True
            )
            assert requested <= len(found) <= nodes
            assert (np.abs(found) < 1e12).all(), "an infinite one is as large as rounding lets it be"


class Failing:
    """Eigensolvers of which the first few fail inside SLEPc."""

    def __init__(self, real, failures, error):
        self.real, self.failures, self.error, self.meshes = real, failures, error, []

    def __call__(self, resolution):
        self.meshes.append(resolution)
        if len(self.meshes) <= self.failures:
            raise self.error
        return self.real(resolution)


@pytest.mark.parametrize("failures", [1, 3])
def test_error_inside_slepc_is_followed_by_another_mesh(monkeypatch, failures):
    rod = Rod(F=30.0, k1=1e4, k2=1e4, gamma3=1e-4)
    whole = solve_spectrum(rod, TIGHT)
    failing = Failing(problem_module.uniform_solver, failures, PETSc.Error(76))
    monkeypatch.setattr(problem_module, "uniform_solver", failing)
    result = solve_spectrum(rod, TIGHT)
    assert (result.status, result.unstable_count, result.certified) == (SpectrumStatus.ok, 0, True)
    assert np.allclose(result.eigenvalues, whole.eigenvalues, rtol=1e-12)
    assert len(set(failing.meshes)) == failures + 1


def test_lasting_error_inside_slepc_is_told(monkeypatch):
    # A PETSc.Error that PETSc did not raise speaks of the last one that it did.
    failing = Failing(
        problem_module.uniform_solver, 10**9, SystemError("Error in LAPACK subroutine trexc: info=1")
    )
    monkeypatch.setattr(problem_module, "uniform_solver", failing)
    result = solve_spectrum(Rod(F=30.0, k1=1e4, k2=1e4, gamma3=1e-4), TIGHT)
    assert (result.status, len(failing.meshes)) == (SpectrumStatus.failed, 4)
    assert result.message == "Error in LAPACK subroutine trexc: info=1"


STRONGLY_PULLED = Rod(F=-1e5, k1=1e8, k2=1e8, gamma3=1.0)
"""The leading eigenvalue is -9e-133; with shifts from 0 to 1e-7 no mesh resolves four modes."""


@pytest.fixture
def fixed_shift(monkeypatch):
    # With the shift 0, under some BLAS kernels a pivot is exactly 0, and SLEPc fails on the last mesh too.
    monkeypatch.setattr(problem_module, "_shift_right_of_waves", lambda rod, growth: 3e-8)


def test_the_shift_of_a_strongly_pulled_rod_is_off_its_leading_eigenvalue():
    found = solve_spectrum(STRONGLY_PULLED, TIGHT)
    assert (found.status, found.certified) == (SpectrumStatus.ok, True)
    assert -1e-132 < found.eigenvalues[0].real < 0
    # The determinant in 420 digits changes its sign there, and at no other of 20 places from -98634 to -1.
    assert found.eigenvalues[1:].real == pytest.approx([-71741.0646803, -95974.0896533, -98632.7060492])


@pytest.mark.usefixtures("fixed_shift")
def test_error_inside_slepc_is_not_the_reason_if_later_meshes_are_solved(monkeypatch):
    rod = STRONGLY_PULLED
    failing = Failing(problem_module.uniform_solver, 1, SystemError("[0] Zero pivot in row 806"))
    monkeypatch.setattr(problem_module, "uniform_solver", failing)
    monkeypatch.setattr(search, "SEARCH_SETTINGS", replace(search.SEARCH_SETTINGS, max_meshes=6))
    result = solve_spectrum(rod, TIGHT)
    assert (result.status, len(failing.meshes) > 4) == (SpectrumStatus.failed, True)
    told = re.fullmatch(r"none of 6 meshes with fewer than (\d+) unknowns resolves .*", result.message)
    assert 0 < int(told[1]) < 10000


@pytest.mark.usefixtures("fixed_shift")
def test_a_search_that_ends_at_the_largest_mesh_names_its_size(monkeypatch):
    for module in (search, problem_module):
        smaller = replace(module.RESOLUTION_SETTINGS, max_unknowns=1000)
        monkeypatch.setattr(module, "RESOLUTION_SETTINGS", smaller)
    result = solve_spectrum(STRONGLY_PULLED, TIGHT)
    assert result.status == SpectrumStatus.failed
    assert result.message == "no mesh of at most 1000 unknowns resolves the requested modes"


def test_a_thin_cone_whose_waves_no_mesh_resolves_names_the_force_and_the_taper():
    """Some 300 waves fit between its clamp and its tip; "try another accuracy" was the only remedy."""
    cone = Rod(F=3.52e3, k1=6.3e6, k2=3.3e5, gamma3=6e-3, taper=0.032)
    result = solve_spectrum(cone, SpectrumRequest(6, 1e-8, certify=True))
    assert result.status == SpectrumStatus.failed
    assert "a smaller |F| or a larger taper" in result.message


def test_two_meshes_name_the_number_of_meshes_without_a_result(monkeypatch):
    monkeypatch.setattr(
        krylov_schur_on_two_meshes,
        "TWO_MESH_SETTINGS",
        replace(krylov_schur_on_two_meshes.TWO_MESH_SETTINGS, max_finer_meshes=0),
    )
    result = solve_on_two_meshes(Rod(F=30.0, k1=1e4, k2=1e4, gamma3=1e-4), TIGHT)
    assert result.status == SpectrumStatus.failed
    assert re.fullmatch(
        r"none of 1 meshes with fewer than \d+ unknowns resolves the requested modes",
        result.message,
    )


def test_overflowing_parameters_fail_with_a_reason_and_harm_no_later_point():
    result = solve_spectrum(Rod(F=1e200, k1=np.inf, k2=1e-5, gamma3=1e-4), TIGHT)
    assert result.status == SpectrumStatus.failed
    assert result.message
    assert solve_spectrum(Rod(F=30.0, k1=1e4, k2=1e4, gamma3=1e-4), TIGHT).status == SpectrumStatus.ok


def test_point_does_not_depend_on_what_was_solved_before(reference_spectra):
    rods = [rod_of(point) for point in reference_spectra[:120:3]]
    first = [solve_spectrum(rod, TIGHT) for rod in rods]
    for rod, before in list(zip(rods, first, strict=True))[::-1]:
        again = solve_spectrum(rod, TIGHT)
        assert np.array_equal(again.eigenvalues, before.eigenvalues)
        assert (again.elements, again.order) == (before.elements, before.order)


def eigenfunction(w, rod, points):
    """(y, theta) at the points, scaled to y(1) = 1, from the first-order system in 40 digits."""
    with mp.workdps(40):
        F, c2, gamma3, nu, g = reference.coefficients(rod.F, rod.k1, rod.k2, rod.gamma3)
        w = reference.refine(mp.mpc(w), rod.F, rod.k1, rod.k2, rod.gamma3)
        A = mp.matrix([[0, nu, c2, 0], [0, 0, 0, 1], [w, 0, 0, F], [0, gamma3 * w, -g, 0]])
        tip = mp.expm(A)
        start = mp.matrix([0, 0, tip[2, 3], -tip[2, 2]])
        states = [mp.expm(A * mp.mpf(float(u))) * start for u in points]
        scale = (tip * start)[0]
        return np.array([complex(s[0] / scale) for s in states]), np.array(
            [complex(s[1] / scale) for s in states]
        )


@pytest.mark.long
@pytest.mark.parametrize(
    "rod",
    [
        Rod(F=30.0, k1=1e4, k2=1e4, gamma3=1e-4),
        Rod(F=30.0, k1=1e4, k2=1e2, gamma3=1e-2),
        Rod(F=150.0, k1=200.0, k2=1e4, gamma3=1e-4),
        Rod(F=99.9, k1=100.0, k2=1e4, gamma3=1e-4),
        Rod(F=30.0, k1=np.inf, k2=np.inf, gamma3=0.0),
        Rod(F=10.0, k1=50.0, k2=np.inf, gamma3=0.0),
        Rod(F=40.0, k1=60.0, k2=5.0, gamma3=2.0),
    ],
    ids=str,
)
def test_vectors_are_the_eigenfunctions_scaled_to_a_unit_tip(rod):
    nodes = 9
    result = solve_spectrum(rod, SpectrumRequest(3, 1e-11, True, nodes))
    assert result.vectors.shape == (2, 3, nodes)
    for w, Y, Theta in zip(result.eigenvalues, *result.vectors, strict=True):
        y, theta = eigenfunction(w, rod, lobatto_points(nodes))
        assert Y[-1] == pytest.approx(1.0)
        assert Y[0] == Theta[0] == 0
        assert np.abs(Y - y).max() < 1e-8 * np.abs(y).max()
        assert np.abs(Theta - theta).max() < 1e-8 * np.abs(theta).max()


def test_without_certificate_the_numbers_are_the_same():
    rod = Rod(F=30.0, k1=1e4, k2=1e2, gamma3=1e-2)
    plain = solve_spectrum(rod, SpectrumRequest(4, 1e-10, certify=False))
    proved = solve_spectrum(rod, SpectrumRequest(4, 1e-10, certify=True))
    assert np.array_equal(plain.eigenvalues, proved.eigenvalues)
    assert (plain.certified, proved.certified) == (False, True)
    assert plain.status == proved.status == SpectrumStatus.ok


INF = np.inf


@pytest.mark.parametrize("certify", [True, False])
@pytest.mark.parametrize(
    ("parameters", "modes", "accuracy", "first", "unstable"),
    [
        # Rounded infinite eigenvalues, which pass for roots by |D/D'| < 1e-3 |w| alone.
        (
            (26.04659802855468, 29287386.853228822, 21412.516508201144, 0.0),
            2,
            1e-6,
            -81.0836121 + 114.6015074j,
            0,
        ),
        ((-30.0, 1e4, 20.0, 0.0), 4, 1e-10, 77.2539904092, 1),
        # Next to the onset, where the two leading modes are nearly one: they must not be dropped.
        ((10.589580275349956, 2624325589.972623, INF, 0.12382152767397504), 1, 1e-4, -36.54212, 0),
        ((7.2777665409750725, 342362964.0940207, INF, 0.6515180987071483), 3, 1e-4, -10.790602, 0),
        # Many unstable modes of which few are asked for.
        ((555.8965078633564, 1e4, INF, 0.7924466867097243), 1, 1e-6, 556.780062570 + 12.6570849j, 6),
        (
            (1965.3051532726147, INF, 409848.6378546153, 2.0920036069589485),
            2,
            1e-10,
            896.468274539 + 1.65020728j,
            14,
        ),
        ((20.0, 1e4, 0.1, 0.0), 4, 1e-10, 345.438443730 + 0.37962835j, 20),
        # g = gamma3 = 0: the two exponents coincide for every w.
        ((-20.0, INF, 20.0, 0.0), 2, 1e-10, -((np.pi / 2) ** 2) * 20, 0),
        # Nearly crushed.
        ((200 * (1 - 1e-8), 200.0, 1e4, 0.0), 4, 1e-10, -41667.2675135, 0),
    ],
)
def test_hard_rods_have_the_right_leading_mode(parameters, modes, accuracy, first, unstable, certify):
    result = solve_spectrum(
        Rod(**dict(zip(("F", "k1", "k2", "gamma3"), parameters, strict=True))),
        SpectrumRequest(modes, accuracy, certify),
    )
    assert result.status in (SpectrumStatus.ok, SpectrumStatus.not_certified)
    assert abs(result.eigenvalues[0] - first) < max(2 * accuracy, 1e-8) * abs(first)
    # Without a proof the count is withheld: where it was asked for, and where the search did not go past.
    assert result.unstable_count == unstable or (not result.certified and result.unstable_count == -1)


def test_pair_at_the_onset_is_kept_without_a_certificate():
    """The certificate is not there to miss it: the nearly double pair has to survive by itself."""
    result = solve_spectrum(
        Rod(F=20.050953618975804, k1=INF, k2=INF, gamma3=0.0), SpectrumRequest(2, 1e-10, False)
    )
    assert result.status == SpectrumStatus.accuracy_not_reached
    assert abs(result.eigenvalues[0] - (-121.34251 + 6.8e-5j)) < 1e-5


def test_resting_modes_a_hundred_deep_are_those_of_the_cantilever():
    result = solve_spectrum(Rod(F=0.0, k1=INF, k2=INF, gamma3=0.0), SpectrumRequest(100, 1e-8, True))
    assert result.status == SpectrumStatus.ok
    n = np.arange(8, 101)
    assert np.allclose(result.eigenvalues[7:].real, -(((n - 0.5) * np.pi) ** 4), rtol=1e-7)


def test_a_solver_that_is_no_longer_kept_gives_its_memory_back():
    """petsc4py would set it aside until the end of the process, some megabyte a resolution."""
    solvers = [
        uniform_solver(Resolution(1, nodes)) for nodes in range(6, 6 + KRYLOV_SETTINGS.max_uniform_solvers)
    ]
    assert uniform_solver(Resolution(1, 6)) is solvers[0]
    uniform_solver(Resolution(2, 6))
    first, longest_unused, *others = solvers
    assert not any((longest_unused.eps, longest_unused.A, longest_unused.B, longest_unused.start_vector))
    assert all(solver.eps and solver.A for solver in (first, *others))


@pytest.mark.parametrize(
    "rod",
    [
        Rod(F=-5194.0, k1=11.8, k2=1e4, gamma3=1e-4),
        Rod(F=-5720.063957251559, k1=146.69144443549771, k2=8487.293996361786, gamma3=0.01988535839262231),
        pytest.param(
            Rod(
                F=-8462.576294803406, k1=2.3491577510136112, k2=5.225251704159751, gamma3=0.08539332871713426
            ),
            marks=pytest.mark.long,
        ),
    ],
)
def test_a_strongly_pulled_rod_has_for_one_mode_the_status_that_it_has_for_more(rod):
    """Layers of a thickness of 1/1500, and leading eigenvalues of -1e-200 near the line of their count; no
    allowed mesh of the last rod is finer than the first."""
    spectra = [solve_spectrum(rod, SpectrumRequest(modes, 1e-8, certify=True)) for modes in (1, 4)]
    assert len({spectrum.status for spectrum in spectra}) == 1
    assert spectra[0].status in (SpectrumStatus.ok, SpectrumStatus.accuracy_not_reached)
    leaders = np.array([spectrum.eigenvalues[0] for spectrum in spectra])
    assert (np.abs(leaders - leaders[-1]) <= 2 * spectra[-1].error_estimate[0]).all()


def test_krylov_schur_on_two_meshes_has_the_reference_spectra_within_its_errors(reference_spectra):
    """D takes no part: the difference of two meshes is the error, and nothing is certified."""
    request = SpectrumRequest(mode_count=4, accuracy=1e-8, certify=False)
    for point in reference_spectra:
        rod = rod_of(point)
        result, exact = solve_on_two_meshes(rod, request), leading(point, 4)
        if rod.g < 0 and result.status == SpectrumStatus.failed:
            continue  # boundary layers too thin for the meshes
        if result.status != SpectrumStatus.ok:
            assert result.status == SpectrumStatus.accuracy_not_reached, rod
            # A pull, or to be all but crushed, makes an eigenvalue less than its rounding.
            assert not 0 <= rod.F <= 0.99 * rod.k1, rod
        apart = np.abs(result.eigenvalues - exact)
        if rod.g > 0 or rod.gamma3 > 0:  # else infinitely many modes grow
            assert (apart <= result.error_estimate).all(), rod
            assert result.unstable_count in (point["unstable"], -1), rod
        assert not result.certified


def test_krylov_schur_on_two_meshes_says_which_mode_misses_the_accuracy_and_why():
    rod = Rod(F=-100.0, k1=1e8, k2=1e6, gamma3=1e-4)
    result = solve_on_two_meshes(rod, SpectrumRequest(mode_count=4, accuracy=1e-12, certify=False))
    assert result.status == SpectrumStatus.accuracy_not_reached
    said = re.fullmatch(
        r"mode (\d) has a relative error of (\S+), limited by rounding errors, but the requested accuracy is "
        r"1.00e-12: use an accuracy above (\S+), or method: determinant",
        result.message,
    )
    relative = result.error_estimate / np.abs(result.eigenvalues)
    assert int(said[1]) == 1 + np.argmax(relative)
    assert float(said[2]) == pytest.approx(relative.max(), rel=0.01)
    better = SpectrumRequest(mode_count=4, accuracy=1.01 * float(said[3]), certify=False)
    assert solve_on_two_meshes(rod, better).status == SpectrumStatus.ok
    assert solve_on_two_meshes(rod, better).message == ""


def test_krylov_schur_on_two_meshes_gives_all_but_the_leading_eigenvalue_of_a_pulled_rod():
    """The leading eigenvalue, -1e-35, is less than rounding errors; all others are accurate, and are said to
    be."""
    rod = Rod(F=-1353.0, k1=153.0, k2=np.inf, gamma3=0.62)
    request = SpectrumRequest(mode_count=4, accuracy=1e-8, certify=False)
    found, exact = solve_on_two_meshes(rod, request), solve_spectrum(rod, TIGHT)
    assert (found.status, exact.status) == (SpectrumStatus.accuracy_not_reached, SpectrumStatus.ok)
    error = np.abs(found.eigenvalues - exact.eigenvalues)
    assert (error <= found.error_estimate).all()
    assert (found.error_estimate[1:] <= 1e-8 * np.abs(found.eigenvalues[1:])).all()


@pytest.mark.kernel
@pytest.mark.parametrize(
    ("F", "k1", "k2", "gamma3"),
    [(-5.16, 2.03e5, 2.09, 3.2e-5), (-44.0, 386.0, 15.1, 1e-5)],
)
def test_krylov_schur_on_two_meshes_states_the_rounding_of_modes_with_thin_layers(F, k1, k2, gamma3):
    """The rounding of rods pulled beyond their shear stiffness is up to 15 times that of other rods."""
    rod = Rod(F=F, k1=k1, k2=k2, gamma3=gamma3)
    found = solve_on_two_meshes(rod, SpectrumRequest(mode_count=4, accuracy=1e-8, certify=False))
    exact = solve_spectrum(rod, SpectrumRequest(mode_count=4, accuracy=1e-12, certify=False))
    assert exact.status == SpectrumStatus.ok
    # A third of the error: what is measured here is less elsewhere.
    assert (np.abs(found.eigenvalues - exact.eigenvalues) <= found.error_estimate / 3).all()


def test_krylov_schur_on_two_meshes_gives_no_number_where_no_mesh_resolves_boundary_layers():
    """A pull beyond the shear stiffness makes layers of the thickness 1/2000 or less: two meshes that are too
    coarse agree to 3e-7 on an eigenvalue with an error of 4e-5."""
    rod = Rod(F=-1600.0, k1=1e6, k2=2.3, gamma3=2.6e-7)
    result = solve_on_two_meshes(rod, SpectrumRequest(mode_count=1, accuracy=1e-8, certify=False))
    assert result.status == SpectrumStatus.failed
    assert re.fullmatch(r"no mesh of at most \d+ unknowns resolves the requested modes", result.message)


@pytest.mark.parametrize(
    ("rod", "cause"),
    [
        (Rod(F=-100.0, k1=1e4, k2=50.0, gamma3=1e-12), "boundary layers are short"),
        (Rod(F=1e9, k1=INF, k2=INF, gamma3=0.0), r"waves as short as 0\.\d+ L grow"),
    ],
)
def test_a_rod_that_no_mesh_resolves_says_what_is_too_short(rod, cause):
    """The waves that grow in the pulled rod are 60 times as long as the rod."""
    result = solve_spectrum(rod, SpectrumRequest(mode_count=1, accuracy=1e-10, certify=False))
    assert result.status == SpectrumStatus.failed
    assert re.search(rf"the requested modes: {cause}; a smaller \|F\| makes them longer$", result.message)


@pytest.mark.parametrize("accuracy", [1e-4, 1e-6, 1e-8, 1e-10])
@pytest.mark.parametrize(
    ("onset", "k1", "k2"),
    [(20.04926815902913, np.inf, 365923.0875981547), (27.555328108729338, 101.18046590242326, np.inf)],
)
def test_krylov_schur_on_two_meshes_states_how_rounding_parts_a_double_eigenvalue(onset, k1, k2, accuracy):
    """At the onset, to the last digit of F, two eigenvalues are within 1e-5 of each other, and rounding moves
    each by 1e-7 or more."""
    rod = Rod(F=onset, k1=k1, k2=k2, gamma3=0.0)
    found = solve_on_two_meshes(rod, SpectrumRequest(mode_count=2, accuracy=accuracy, certify=False))
    exact = solve_spectrum(rod, SpectrumRequest(mode_count=2, accuracy=1e-4, certify=True)).eigenvalues
    error = np.abs(found.eigenvalues[:, None] - exact).min(axis=1)
    assert (error <= found.error_estimate).all()
    assert (found.error_estimate < 1e-5 * np.abs(exact)).all()


def test_krylov_schur_on_two_meshes_is_sparse_where_elements_are_many():
    rod, request = (
        Rod(F=390.0, k1=1e4, k2=15.0, gamma3=1e-3),
        SpectrumRequest(mode_count=30, accuracy=1e-8, certify=False),
    )
    result, reference = solve_on_two_meshes(rod, request), solve_spectrum(rod, TIGHT)
    assert result.status == SpectrumStatus.ok
    assert 3 * result.elements * result.order > KRYLOV_SETTINGS.max_dense_unknowns
    assert np.abs(result.eigenvalues[:4] / reference.eigenvalues - 1).max() < 1e-8


def test_krylov_schur_on_two_meshes_gives_the_vectors_that_the_search_gives():
    rod, request = (
        Rod(F=60.0, k1=200.0, k2=1e4, gamma3=1e-4),
        SpectrumRequest(3, 1e-6, certify=False, vector_node_count=9),
    )
    found, reference = solve_on_two_meshes(rod, request), solve_spectrum(rod, request)
    assert found.vectors.shape == (2, 3, 9)
    assert np.abs(found.vectors - reference.vectors).max() < 1e-6 * np.abs(reference.vectors).max()
