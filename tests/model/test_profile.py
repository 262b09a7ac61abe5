"""Profiles: smooth between rows, monotone, jumps where two rows stand at one u, bad tables refused."""

from fractions import Fraction

import numpy as np
import pytest
from scipy.interpolate import PchipInterpolator

from rodsweep.determinant.arm.elements.edges import two_sum
from rodsweep.model.material.factors import factors_along, smallest_factor_along
from rodsweep.model.material.profile import FACTOR_NAMES, Profile
from rodsweep.model.material.rod_material import RodMaterial
from rodsweep.model.rod import Rod


def profile(u, k3):
    """A profile in which k3 alone varies."""
    return Profile(tuple(u), tuple(tuple(v if name == "k3" else 1.0 for name in FACTOR_NAMES) for v in k3))


def test_factors_meet_the_rows_and_stay_between_them():
    u, k3 = [0.0, 0.2, 0.5, 0.9, 1.0], [1.0, 4.0, 4.5, 0.01, 0.02]
    table = profile(u, k3)
    inside = np.linspace(0, 1, 4001)[1:-1]
    values = table.factors_at(inside)[FACTOR_NAMES.index("k3")]
    np.testing.assert_allclose(np.interp(u[1:-1], inside, values), k3[1:-1], rtol=1e-3)
    for a, b, low, high in zip(u[:-1], u[1:], k3[:-1], k3[1:], strict=True):
        between = values[(inside > a) & (inside < b)]
        assert min(low, high) <= between.min() and between.max() <= max(low, high)
    slopes = np.diff(values) / np.diff(inside)
    assert np.abs(np.diff(slopes)).max() < 0.2  # no corner: a chord's slope jumps by 15 at u = 0.2


@pytest.mark.parametrize("rows", [3, 4, 9])
def test_factors_are_the_monotone_cubics_of_scipy(rows):
    """As docs/howto/shaped-arms.md says, on both sides of a jump."""
    rng = np.random.default_rng(rows)
    part = np.concatenate([[0.0], np.sort(rng.uniform(0.1, 0.9, rows - 2)), [1.0]]) / 2
    k3 = np.exp(rng.uniform(-3, 3, 2 * rows))
    table = profile([*part, *(0.5 + part)], k3)
    for shift, values in ((0.0, k3[:rows]), (0.5, k3[rows:])):
        u = shift + np.linspace(0, 0.5, 203)[1:-1]
        factors = table.factors_at(u)[FACTOR_NAMES.index("k3")]
        np.testing.assert_allclose(factors, PchipInterpolator(part + shift, values)(u), rtol=1e-12)


@pytest.mark.parametrize("k3", [(1e3, 1e-3), (1e-3, 1e3), (1e3, 1e-3, 1.0), (1.0, 1e3, 1e-3)])
def test_a_factor_that_falls_to_a_millionth_keeps_its_digits(k3):
    """Against the same cubic polynomials in rational numbers. Up to the middle of an interval the terms add
    up to at most 27 times the factor (if its fall begins with three times the slope of the chord), and each
    has lost some eps: 3e-14. Powers of the distance from the row before lost 4e-12 to 2e-10.
    """
    u = [i / (len(k3) - 1) for i in range(len(k3))]
    points = [(i + 0.5) / 2**13 for i in range(2**13)]
    values = profile(u, k3).factors_at(np.array(points))[FACTOR_NAMES.index("k3")]
    errors = [
        abs(Fraction(float(value)) / exact_factor(u, k3, point) - 1)
        for value, point in zip(values, points, strict=True)
    ]
    assert max(errors) < 3e-14


def exact_factor(u, k3, point):
    """The monotone cubic of Fritsch and Carlson through up to three equidistant rows, as a Fraction."""
    rows = [Fraction(value) for value in k3]
    rises = [after - before for before, after in zip(rows[:-1], rows[1:], strict=True)]
    if len(rows) == 2:
        slopes = rises * 2
    else:
        first, second = rises
        ends = [(3 * first - second) / 2, (3 * second - first) / 2]
        kept = [end if end * rise > 0 else Fraction(0) for end, rise in zip(ends, rises, strict=True)]
        if first * second <= 0:
            kept = [
                3 * rise if abs(end) > 3 * abs(rise) else end for end, rise in zip(kept, rises, strict=True)
            ]
        middle = 2 * first * second / (first + second) if first * second > 0 else Fraction(0)
        slopes = [kept[0], middle, kept[1]]
    place = Fraction(point) * len(rises)
    piece = int(place)
    t = place - piece
    y, rise, start, end = rows[piece], rises[piece], slopes[piece], slopes[piece + 1]
    return y + t * start + t**2 * (3 * rise - 2 * start - end) + t**3 * (start + end - 2 * rise)


def test_two_rows_at_one_place_are_a_jump():
    table = profile([0.0, 0.4, 0.4, 1.0], [1.0, 1.0, 100.0, 50.0])
    before, after = table.factors_at(np.array([0.4 - 1e-12, 0.4 + 1e-12]))[FACTOR_NAMES.index("k3")]
    assert before == 1
    assert after == pytest.approx(100, rel=1e-9)
    np.testing.assert_allclose(
        table.factors_at(np.array([0.7]))[FACTOR_NAMES.index("k3")], 75
    )  # two rows: a line


@pytest.mark.parametrize(
    ("u", "k3", "sentence"),
    [
        ((0.1, 1.0), (1, 1), "the rows go from u = 0.1 to 1; they must go from 0 to 1"),
        ((0.0, 0.9), (1, 1), "the rows go from u = 0 to 0.9"),
        ((0.0, 1.0000001), (1, 1), "the rows go from u = 0 to 1.0000001; they must go from 0 to 1"),
        ((0.0,), (1,), "the number of rows is 1"),
        ((0.0, 0.6, 0.5, 1.0), (1, 1, 1, 1), "u = 0.5 follows u = 0.6"),
        ((0.0, 0.5, 0.49999999, 1.0), (1, 1, 1, 1), "u = 0.49999999 follows u = 0.5"),
        ((0.0, 0.5, 0.5, 0.5, 1.0), (1, 1, 1, 1, 1), "there are 3 rows at u = 0.5"),
        ((0.0, 0.0, 1.0), (1, 1, 1), "there are 2 rows at u = 0"),
        ((0.0, 1.0), (1, 0), "the factor of k3 at u = 1 is 0; it must be finite and above 0"),
        ((0.0, 0.5, 1.0), (1, 1e308, 1), "the largest factor is 1e.308, and interpolation between the rows "),
        ((0.0, 1.0), (1, np.inf), "the factor of k3 at u = 1 is inf"),
    ],
)
def test_tables_that_are_no_profile_are_refused(u, k3, sentence):
    with pytest.raises(ValueError, match=sentence):
        profile(u, k3)


@pytest.mark.parametrize("taper", [0.0, -1.0, np.inf, np.nan])
def test_a_taper_of_a_point_is_refused(taper):
    with pytest.raises(ValueError, match="is not a number from 0.01 to 100"):
        Rod(F=1.0, k1=100.0, k2=50.0, gamma3=0.01, taper=taper)


def test_a_cone_scales_as_its_radius():
    """r = 0.75 in the middle of a cone of radius ratio 1/2."""
    rod = Rod(F=3.0, k1=100.0, k2=50.0, gamma3=0.01, taper=0.5)
    here = rod.local_coefficients(np.array([0.5]))
    np.testing.assert_allclose(1 / here.c2, 50 * 0.75**2)
    np.testing.assert_allclose(1 / here.c3, 0.75**4)
    np.testing.assert_allclose(here.gamma3, 0.01 * 0.75**2)
    np.testing.assert_allclose(here.nu, 1 - 3 / (100 * 0.75**2))
    np.testing.assert_allclose(here.g, here.nu + 3 * here.c2)
    assert here.gamma2 == 1


@pytest.mark.parametrize(
    "table", [None, Profile((0.0, 0.4, 0.4, 1.0), ((1.0,) * 6,) * 2 + ((0.5,) * 6,) * 2)]
)
def test_coefficients_do_not_depend_on_those_computed_before(table):
    """Factors along the arm are cached, so a changed result must not change the next one."""
    rod = Rod(F=5.0, k1=1e3, k2=1e2, gamma3=1e-3, taper=0.7, material=RodMaterial(profile=table))
    u = np.linspace(0.05, 0.95, 10)
    first = [np.array(part) for part in rod.local_coefficients(u)]
    for changed in rod.local_coefficients(u):
        changed[:] = 0.0
    assert all((a == b).all() for a, b in zip(first, rod.local_coefficients(u), strict=True))
    by_point = [rod.local_coefficients(u[i : i + 1]) for i in range(len(u))]
    for a, *each in zip(first, *by_point, strict=True):
        assert a == pytest.approx(np.concatenate(each), rel=1e-15)


@pytest.mark.parametrize("taper", [0.015, 0.0268, 0.3, 0.999999, 1.0001, 60.0])
def test_factors_of_a_cone_keep_their_digits(taper):
    """Against rational numbers: at given u, and at positions u + remainder that no double holds."""
    start = np.array([0.0, 0.3, 0.97, 1 - 1e-9, 0.1])
    offset = np.array([1e-9, 0.1 / 3, 0.01 / 7, 1e-10 / 3, 0.9 - 1e-9 / 3])
    u, remainder = two_sum(start, offset)
    for position, exact in (((u, None), u), ((u, remainder), None)):
        radii = np.sqrt(factors_along(None, taper, *position)["k1"])
        for i, radius in enumerate(radii.tolist()):
            point = Fraction(start[i]) + Fraction(offset[i]) if exact is None else Fraction(exact[i])
            assert radius == pytest.approx(float(1 - (1 - Fraction(taper)) * point), rel=1e-15, abs=0)


def test_factors_keep_their_digits_close_to_a_row():
    """A factor that falls to 1e-6 of its value at the tip changes by the rounding of u itself."""
    table = profile([0.0, 1.0], [1.0, 1e-6])
    u, remainder = two_sum(np.array([0.999999]), np.array([1e-6 / 3]))
    exact = 1 + (Fraction(1e-6) - 1) * (Fraction(0.999999) + Fraction(1e-6 / 3))
    factor = factors_along(table, 1.0, u, remainder)["k3"][0]
    assert factor == pytest.approx(float(exact), rel=1e-14, abs=0)
    assert factors_along(table, 1.0, u)["k3"][0] != pytest.approx(float(exact), rel=1e-12, abs=0)


@pytest.mark.parametrize("taper", [0.35, 1.34])
def test_the_weakest_section_between_two_rows_is_exact(taper):
    """The product of a cubic polynomial and the square of a radius has its minimum between the rows; a search
    among samples found a crushing force 4e-5 too large."""
    u, k1 = (0.0, 0.1, 0.1, 0.4, 1.0), (2.0, 2.2, 2.6, 0.24, 1.1)
    table = Profile(u, tuple((k, 1.0, 1.0, 1.0, 1.0, 1.0) for k in k1))
    # Between samples the minimum is lower by less than the square of their distance times the curvature.
    points = np.linspace(0, 1, 1_000_003)[1:-1]
    sampled = (factors_along(table, taper, points)["k1"]).min()
    assert smallest_factor_along(table, taper, "k1") == pytest.approx(sampled, rel=1e-9)
    assert smallest_factor_along(table, taper, "k1") <= sampled


def test_the_smallest_factor_of_extreme_tables_is_found():
    for k1 in ((1e300, 1e-300), (1e-300, 1e300, 1.0), (1.0, 1.0, 1.0), (1e-310, 1.0, 5.0)):
        rows = tuple((k, 1.0, 1.0, 1.0, 1.0, 1.0) for k in k1)
        table = Profile(tuple(np.linspace(0, 1, len(k1)).tolist()), rows)
        assert smallest_factor_along(table, 1.0, "k1") == min(k1)
        assert 0 < smallest_factor_along(table, 0.01, "k1") <= min(k1)
