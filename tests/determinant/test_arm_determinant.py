"""D of arms against the closed form of uniform rods, against an ODE solver, and against published digits."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from rodsweep.determinant.arm.determinant import ArmDeterminant, coefficient_samples, elements_for
from rodsweep.determinant.arm.elements.distinct_elements import distinct_element_indices
from rodsweep.determinant.arm.elements.evaluation import (
    fill_propagator_and_derivative,
    powers_and_derivatives,
)
from rodsweep.determinant.arm.elements.minor_rates import PROPAGATOR_LENGTH
from rodsweep.determinant.arm.elements.propagators import element_propagators
from rodsweep.determinant.value import scaled_determinant
from rodsweep.model.material.profile import FACTOR_NAMES, Profile
from rodsweep.model.material.rod_material import RodMaterial
from rodsweep.model.rod import Rod

PLACES = (0.3 + 0j, -2.0 + 0j, 40j, -300 + 700j, -3000 + 20j, 2e4j, 1e6j)
JUMP = Profile(
    (0.0, 0.3, 0.3, 0.7, 1.0),
    tuple(
        tuple(dict(zip(FACTOR_NAMES, row, strict=True)).values())
        for row in (
            (1.0, 1.0, 1.0, 1.0, 1.0, 1.0),
            (1.2, 0.8, 1.1, 1.0, 1.0, 2.0),
            (0.1, 0.2, 0.05, 1.0, 0.7, 0.5),
            (0.2, 0.2, 0.04, 1.0, 0.9, 0.5),
            (0.2, 0.1, 0.02, 1.0, 0.9, 0.1),
        )
    ),
)


@pytest.mark.parametrize(
    "rod",
    [
        Rod(F=37.0, k1=1e4, k2=1e4, gamma3=1e-4),
        Rod(F=2000.0, k1=np.inf, k2=np.inf, gamma3=0.0),
        Rod(F=90.0, k1=100.0, k2=20.0, gamma3=0.5),
        Rod(F=-40.0, k1=300.0, k2=200.0, gamma3=1e-3),
    ],
    ids=["stiff", "filament", "soft", "pulled"],
)
@pytest.mark.parametrize("w", PLACES)
def test_uniform_rods_have_the_closed_form(rod, w):
    found, closed = ArmDeterminant(rod).value(w), scaled_determinant(w, rod.coefficients)
    ratio = found.D / closed.D * np.exp(found.log_scale - closed.log_scale)
    assert abs(ratio - 1) <= 2e-13 + 4 * closed.rounding_error / abs(closed.D)
    assert abs(found.D_w / found.D / (closed.D_w / closed.D) - 1) <= 2e-11 + 40 * closed.rounding_error / abs(
        closed.D
    )


def by_ode(rod, w):
    """D at w by an explicit Runge-Kutta method of order eight between the breaks."""
    columns = np.zeros((4, 2), complex)
    columns[2, 0] = columns[3, 1] = 1.0

    def rates(u, x):
        nu, c2, c3, gamma2, gamma3, g = (values[0] for values in rod.local_coefficients(np.array([u])))
        y, theta, s, m = x.reshape(4, 2)
        rows = nu * theta + c2 * s, c3 * m, w * gamma2 * y + rod.F * c3 * m, w * gamma3 * theta - g * s
        return np.concatenate(rows)

    for a, b in zip(rod.material.breaks[:-1], rod.material.breaks[1:], strict=True):
        inside = (a + 1e-13, b - 1e-13)  # at a break itself the coefficients are those of one side
        solution = solve_ivp(rates, inside, columns.ravel(), method="DOP853", rtol=1e-13, atol=1e-14)
        columns = solution.y[:, -1].reshape(4, 2)
    return columns[2, 0] * columns[3, 1] - columns[2, 1] * columns[3, 0]


@pytest.mark.parametrize(
    ("taper", "material"),
    [
        (0.2, RodMaterial()),
        (3.0, RodMaterial()),
        (1.0, RodMaterial(law="neo_hookean")),
        (0.6, RodMaterial(law="neo_hookean", section="swelling")),
        (1.0, RodMaterial(profile=JUMP)),
        (0.7, RodMaterial(law="neo_hookean", section="swelling", profile=JUMP)),
    ],
    ids=["thin tip", "thick tip", "rubber", "swelling cone", "jump", "everything"],
)
@pytest.mark.parametrize("w", [-2.0 + 0j, 60j, -40 + 90j])
def test_arms_that_vary_agree_with_an_ode_solver(taper, material, w):
    rod = Rod(F=1.5, k1=300.0, k2=80.0, gamma3=0.02, taper=taper, material=material)
    found = ArmDeterminant(rod).value(w)
    expected = by_ode(rod, w)
    assert abs(found.D * np.exp(found.log_scale) / expected - 1) < 1e-9
    step = 1e-4 * abs(w)
    after, before = (ArmDeterminant(rod).value(w + sign * step) for sign in (1, -1))
    slope = (after.D * np.exp(after.log_scale) - before.D * np.exp(before.log_scale)) / (2 * step)
    assert abs(found.D_w * np.exp(found.log_scale) / slope - 1) < 1e-6


@pytest.mark.parametrize("w", [20j, -50 + 200j, 3000.0 + 0j])
def test_elements_at_a_thin_tip_resolve_the_exponentials(w):
    """Between the points where local waves are sampled they grew by exp(24) over one element, and D was off
    by 7e-3 without a word."""
    determinant = ArmDeterminant(Rod(F=-1.6266, k1=3940.8, k2=763.5, gamma3=0.0884, taper=0.01602))
    found, finer = determinant.value(w), determinant.value_on_finer_elements(w, 1e3)
    assert abs(found.D / finer.D * np.exp(found.log_scale - finer.log_scale) - 1) < 1e-11


def test_cone_of_radius_ratio_one_half_flutters_where_collocation_says():
    """Issue-independent digits: F = 15.4627583986, frequency 175.530930682 (collocation at two sizes)."""
    rod = Rod(F=15.4627583986, k1=1e4, k2=1e4, gamma3=1e-4, taper=0.5)
    here = ArmDeterminant(rod).value(175.530930682j)
    assert abs(here.D / here.D_w) < 1e-8


@pytest.mark.parametrize("law", ["neo_hookean"])
@pytest.mark.parametrize("section", ["fixed", "swelling"])
@pytest.mark.parametrize("F", [-50.0, 1e-3, 60.0, 900.0])
def test_uniform_rods_of_rubber_are_equivalent_to_linear_ones(law, section, F):
    rod = Rod(F=F, k1=500.0, k2=70.0, gamma3=0.01, material=RodMaterial(law=law, section=section))
    linear, rate = rod.equivalent_linear_rod_and_rate_factor
    for w in PLACES[:5]:
        found = ArmDeterminant(rod).value(w)
        closed = scaled_determinant(w / rate, linear.coefficients)
        assert abs(
            found.D * np.exp(found.log_scale - closed.log_scale) / closed.D - 1
        ) <= 1e-12 + 8 * closed.rounding_error / abs(closed.D)


@pytest.mark.parametrize("size", [1e16, 1e200, np.inf])
def test_sizes_that_no_elements_resolve_are_refused(size):
    """A number of elements beyond the integers once became one element, and D was wrong without a word."""
    determinant = ArmDeterminant(Rod(F=10.0, k1=1e4, k2=1e4, gamma3=1e-4, taper=0.5))
    with pytest.raises(FloatingPointError, match="needs more than the maximum of .* elements"):
        determinant.value(complex(size))


RANDOM = np.random.default_rng(20)
ARMS = [
    Rod(
        F=float(RANDOM.uniform(-40, 60)),
        k1=10 ** float(RANDOM.uniform(2.3, 5)),
        k2=10 ** float(RANDOM.uniform(1, 5)),
        gamma3=10 ** float(RANDOM.uniform(-6, 0)),
        taper=float(RANDOM.uniform(0.15, 2.5)),
        material=RodMaterial(profile=JUMP)
        if case % 3 == 0
        else RodMaterial(law="neo_hookean", section="swelling"),
    )
    for case in range(6)
]


@pytest.mark.long
@pytest.mark.parametrize("z", [1e-9j, -3e-5, 0.002 + 0.001j, 0.04j, -0.2 + 0.1j, 0.45, -0.7j, 1.0])
@pytest.mark.parametrize("arm", range(len(ARMS)))
def test_left_out_powers_of_w_do_not_matter(arm, z):
    """The propagators and their derivatives from the powers that count, against all in long doubles."""
    for size in (20.0, 2e3, 2e5):
        W, polynomials = ArmDeterminant(ARMS[arm]).propagators_for(size, 1.0)
        terms = polynomials.shape[1]
        powers = powers_and_derivatives(complex(z), terms)
        assert len(powers) < terms or abs(z) > 1e-4
        n = np.arange(terms)[:, None]
        power = np.clongdouble(z) ** n
        slope = n * np.clongdouble(z) ** np.maximum(n - 1, 0)
        found = np.empty((4, PROPAGATOR_LENGTH))
        for polynomial in polynomials:
            fill_propagator_and_derivative(polynomial, powers, found)
            for values, weight in ((found[:2], power), (found[2:], slope)):
                all_terms = weight * polynomial
                error = np.abs(values[0] + 1j * values[1] - all_terms.sum(axis=0)).max()
                assert error <= 20 * np.finfo(float).eps * np.abs(all_terms).sum(axis=0).max()


@pytest.mark.parametrize("w", [0.3, -2.0, -40.0, -900.0, 700.0])
def test_values_at_real_w_are_real_and_those_beside_the_axis(w):
    for rod in ARMS:
        determinant = ArmDeterminant(rod)
        real, beside = determinant.value(complex(w)), determinant.value(complex(w, 1e-280))
        assert (real.D.imag, real.D_w.imag) == (0.0, 0.0)
        D, D_w = (value * np.exp(beside.log_scale - real.log_scale) for value in (beside.D, beside.D_w))
        assert abs(real.D - D) <= real.rounding_error
        assert abs(real.D_w - D_w) <= 1e-13 * abs(D_w) + real.rounding_error / abs(w)


STEPS = Profile((0.0, 0.4, 0.4, 1.0), tuple((r**2, r**2, r**4, 1.0, 1.0, r**2) for r in (1.0, 1.0, 0.6, 0.6)))


@pytest.mark.parametrize(
    ("taper", "profile", "different"), [(1.0, STEPS, 2), (0.5, STEPS, None), (1.0, JUMP, None)]
)
def test_only_equal_elements_share_a_propagator(taper, profile, different):
    rod = Rod(F=14.0, k1=1e4, k2=1e2, gamma3=1e-2, taper=taper, material=RodMaterial(profile=profile))
    W = 3e4
    elements = elements_for([rod], coefficient_samples([rod]), W)
    numbers = distinct_element_indices(elements.local_coefficients, elements.lengths)
    assert numbers[-1] + 1 == (different or len(numbers)) and len(numbers) > 8
    shared = element_propagators([rod.F], elements.local_coefficients, elements.lengths, W)[0]
    for e in range(len(numbers)):
        part = slice(e, e + 1)
        alone = element_propagators(
            [rod.F], elements.local_coefficients[:, :, part], elements.lengths[part], W
        )[0, 0]
        # The lengths of elements are rounded, relative to a length of about 0.1, by up to 2e-15.
        bound = 1e-13 * np.abs(alone).max()
        assert np.abs(shared[e, : len(alone)] - alone).max() <= bound
        assert np.abs(shared[e, len(alone) :]).max(initial=0.0) <= bound
