"""At the onset F* two real eigenvalues coincide: D = D_w = 0.

Known exactly: F* to 30 digits (`tests/reference/thresholds.json`), and the two eigenvalues at F* (1 + d),
which are apart by about sqrt(d). A backward error e moves a double eigenvalue by sqrt(e), so that of 16
digits 8 are left at F*, while F* itself, a simple root of a pair of equations, keeps all.
"""

import numpy as np
import pytest
from rods import rod_of
from surveyed import few

from rodsweep.discretization.straight.pencil import assemble_pencil
from rodsweep.model.rod import Rod
from rodsweep.solve.changes.status import ThresholdStatus
from rodsweep.solve.changes.thresholds import ThresholdsRequest, solve_thresholds
from rodsweep.solve.modes.inverse_iteration import mode_vectors
from rodsweep.solve.modes.leading_modes import ModesRequest, solve_modes
from rodsweep.solve.spectrum.status import SpectrumStatus

from .adjoint import condition
from .exact import leading
from .promises import all_broken, broken_promises, spectrum, true_errors
from .rods import BESIDE, DOUBLE, EXCEPTIONAL, at_force

pytestmark = pytest.mark.kernel


def rod_at(place, offset=0.0):
    *rod, event = place
    return at_force(event["F"], offset, *rod)


def name(place):
    return f"{place[0]:g}-{place[1]:g}-{place[2]:g}-{float(place[3]['F']):.4f}"


@pytest.mark.parametrize("place", EXCEPTIONAL, ids=name)
def test_eigenvalues_at_a_double_root_say_that_half_of_the_digits_are_lost(place):
    rod = rod_at(place)
    found, error = spectrum(rod), true_errors(rod)
    assert found.status == SpectrumStatus.accuracy_not_reached
    assert (found.certified, found.unstable_count) == (True, 0)
    assert broken_promises(rod) == []
    relative = found.error_estimate / abs(found.eigenvalues)
    assert 1e-10 < relative[:2].max() < 3e-6
    assert (error / abs(found.eigenvalues))[:2].max() < 1e-6
    assert relative[2:].max() < 1e-12, "the other modes lose nothing"


@pytest.mark.parametrize("accuracy", [1e-6, 1e-7, 3e-8, 1e-8, 3e-9])
def test_at_a_double_root_ok_is_said_only_where_the_digits_asked_for_are_there(accuracy):
    """Between the digits that are lost and those that are left: D/D' alone tells half of the error there."""
    assert all_broken([rod_at(place) for place in EXCEPTIONAL], accuracy=accuracy) == []


@pytest.mark.parametrize("accuracy", [1e-12, 1e-6])
@pytest.mark.parametrize("place", EXCEPTIONAL, ids=name)
def test_eigenvalues_beside_a_double_root_are_as_accurate_as_they_say(place, accuracy):
    """Ok only where every digit asked for is right; the count is proved all the same."""
    rods = [rod_at(place, offset) for offset in BESIDE]
    assert all_broken(rods, accuracy=accuracy) == []
    assert all(spectrum(rod, 4, accuracy).certified for rod in rods)
    if accuracy == 1e-6:
        assert all(spectrum(rod, 4, accuracy).status == SpectrumStatus.ok for rod in rods)


@pytest.mark.parametrize("place", EXCEPTIONAL, ids=name)
def test_the_threshold_keeps_all_the_digits_that_the_eigenvalues_lose(place):
    k1, k2, gamma3, event = place
    F = event["F"]
    end = min(1.05 * float(F), 0.999 * k1)
    found = solve_thresholds(Rod(F=0.0, k1=k1, k2=k2, gamma3=gamma3), ThresholdsRequest(end, 1e-12, True, 16))
    assert found.status == ThresholdStatus.ok
    nearest = min(found.thresholds, key=lambda c: abs(c.value - float(F)))
    assert nearest.kind.name in DOUBLE
    assert nearest.value == pytest.approx(float(F), rel=1e-12)
    assert abs(nearest.value - float(F)) <= 10 * nearest.error


@pytest.mark.parametrize("place", EXCEPTIONAL[:4], ids=name)
def test_condition_number_and_splitting_follow_the_square_root(place):
    """Per decade of |F - F*| the pair comes closer by sqrt(10) and its condition number grows by sqrt(10)."""
    for sign in (1, -1):
        at = [solve(rod_at(place, sign * size)) for size in (1e-4, 1e-6, 1e-8)]
        apart = [abs(np.subtract(*result.spectrum.eigenvalues)) for result in at]
        numbers = [result.mode_vectors.condition[0] for result in at]
        assert np.diff(np.log10(apart)) == pytest.approx([-1, -1], abs=5e-3)
        assert np.diff(np.log10(numbers)) == pytest.approx([1, 1], abs=5e-3)


def solve(rod, accuracy=1e-8):
    return solve_modes(rod_of(*rod), ModesRequest(2, accuracy, 9, False))


def least_condition(place, there):
    """What rounding leaves at least of the condition numbers at F*, which are infinite.

    With c = |psi| |xi| and (psi, xi) = b (w1 - w2) of two close eigenvalues the condition number is K = c/|b
    (w1 - w2)|, so that K |w1 - w2| = c/|b| beside F* is that of F*. There rounding of (A - w B) x moves the
    two apart to |w1 - w2| = 2 sqrt(e/|b|), e = |(psi, rounding)|, which leaves K = sqrt((c/|b|) (c/e))/2. c/e
    is the condition number over its `ModeVectors.eigenvalue_rounding`, in both of which (psi, xi) cancels.
    """
    beside = rod_at(place, 1e-8)
    first, second = leading(beside, 4)[:2]
    c_over_b = float(condition(beside, first) * abs(first - second))
    mesh = assemble_pencil(there.mode_vectors.resolution.element_count, there.mode_vectors.resolution.order)
    shapes = mode_vectors(rod_of(*rod_at(place)), mesh, there.spectrum.eigenvalues, np.array([0.0, 1.0]))
    return np.sqrt(c_over_b * shapes.condition / shapes.eigenvalue_rounding) / 2


WORST_ROUNDING = 4.0
"""In units of `ModeVectors.eigenvalue_rounding`, the root of a sum of many squares: four standard
deviations."""


@pytest.mark.long
@pytest.mark.parametrize("place", few(EXCEPTIONAL, 2), ids=name)
def test_condition_numbers_at_and_beside_a_double_root_are_as_accurate_as_they_say(place):
    """At F* they are as large as rounding allows, and not called accurate; beside it ok means right."""
    there = solve(rod_at(place))
    assert there.status == SpectrumStatus.accuracy_not_reached
    assert (there.mode_vectors.condition > least_condition(place, there) / np.sqrt(WORST_ROUNDING)).all()
    assert there.mode_vectors.condition_error.min() > 1
    broken = []
    for offset in (1e-10, 1e-8, -1e-8, 1e-6, -1e-6, 1e-4):
        rod = rod_at(place, offset)
        found = solve(rod)
        error = abs(found.mode_vectors.condition[0] / float(condition(rod, leading(rod, 4)[0])) - 1)
        if error > 10 * found.mode_vectors.condition_error[0] or (
            found.status == SpectrumStatus.ok and error > 1e-8
        ):
            broken.append(
                f"{rod} {found.status.name}: error {error:.1e}, "
                f"said {found.mode_vectors.condition_error[0]:.1e}"
            )
    assert broken == []
