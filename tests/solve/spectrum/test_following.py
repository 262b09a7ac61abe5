"""Spectra that are followed along a grid: equal to those of single points, and counted rightly."""

import math
from itertools import pairwise
from types import SimpleNamespace

import numpy as np
import pytest
from followed_lines import Comparison, line, random_line, solve_stretch
from surveyed import RODS

from rodsweep.determinant import moving_line
from rodsweep.determinant.certificate.winding_number import count_right_of, phase_change_by_nodes
from rodsweep.determinant.moving_line import (
    RodAndLineAtEnd,
    no_crossing_proof_and_count,
    rectangle_proof_and_costs,
)
from rodsweep.determinant.parameter_path import ParameterPath
from rodsweep.model.rod import Coefficients, Rod
from rodsweep.solve.spectrum.path import neighbouring_rods
from rodsweep.solve.spectrum.path.eigenvalue_prediction import extrapolate_hermite
from rodsweep.solve.spectrum.search import SpectrumRequest, solve_spectrum
from rodsweep.solve.spectrum.status import SpectrumStatus

CORNERS = ((-1, -1), (1, -1), (1, 1), (-1, 1))
REQUEST = SpectrumRequest(4, 1e-10, certify=True)
LINES = {
    "onset, Hopf point": line("F", np.linspace(0, 60, 200), k1=1e4, k2=1e4, gamma3=1e-4),
    "backwards in 1/k2": line("k2", np.geomspace(30, 1e4, 200), F=25, k1=1e4, gamma3=1e-2),
    "restabilization": line("F", np.linspace(100, 199, 150), k1=200, k2=1e4, gamma3=1e-4),
    "k1 near crushing": line("k1", 30 * (1 + np.geomspace(1e-5, 10, 150)), F=30, k2=1e4, gamma3=1e-4),
    "crushing without shear": line("k1", 30 * (1 + np.geomspace(1e-3, 10, 100)), F=30, k2=math.inf, gamma3=0),
    "twelve unstable": line("F", np.linspace(800, 2200, 120), k1=1e4, k2=1e4, gamma3=1e-4),
    "filament": line("F", np.linspace(0, 120, 200), k1=math.inf, k2=math.inf, gamma3=0),
    "no drag": line("F", np.linspace(0, 80, 150), k1=1e4, k2=100, gamma3=0),
    "drag from 0": line("gamma3", [0, *np.geomspace(1e-6, 3, 120)], F=40, k1=1e4, k2=100),
    "to rigid": line("k2", [*np.geomspace(20, 1e6, 100), math.inf], F=35, k1=1e3, gamma3=1e-3),
    "pull and push": line("F", np.linspace(-40, 60, 150), k1=1e3, k2=200, gamma3=1e-3),
    "coarse": line("F", np.linspace(0, 90, 12), k1=200, k2=1e4, gamma3=1e-4),
    "very coarse": line("k2", np.geomspace(1, 1e6, 8), F=90, k1=200, gamma3=1e-2),
}


COMPARED = 12
"""Points of each line that are compared, at least; `make survey` compares all. All are followed, and counted
beside their neighbours, so that what goes wrong at a point lasts."""


@pytest.mark.parametrize("name", LINES)
def test_followed_spectra_are_those_of_single_points(name):
    """Eigenvalues to 1e-13 or within both error estimates; counts as LAPACK's on whole matrices."""
    comparison, whole = Comparison(), LINES[name]
    comparison.add(whole, every=1 if RODS else max(1, len(whole) // COMPARED))
    assert comparison.differences == []
    assert comparison.followed > 0.9 * comparison.points
    assert comparison.counted > 0.5 * comparison.points
    assert comparison.unstable >= (12 if name == "twelve unstable" else 0)


@pytest.mark.long
def test_random_lines_give_the_spectra_of_single_points():
    rng, comparison = np.random.default_rng(7), Comparison()
    for _ in range(25):
        comparison.add(random_line(rng), modes=int(rng.integers(1, 7)), dense=False)
    assert comparison.differences == []
    assert comparison.followed > 0.9 * comparison.points


def eigenvalues(rod: Rod, modes: int = 7) -> np.ndarray:
    return solve_spectrum(rod, SpectrumRequest(modes, 1e-10, certify=True)).eigenvalues


def random_strips(count: int):
    """(ends, direction, counts at both) of lines in gaps between eigenvalues: as many before both, or not."""
    rng = np.random.default_rng(31)
    while count:
        whole = random_line(rng)
        i, j = sorted(rng.choice(len(whole), 2, replace=False))
        ends, counts = [], []
        for at, gap in zip((i, j), rng.integers(2, 6, 2), strict=True):
            rod = whole.rod_at(int(at))
            w = eigenvalues(rod)
            at_line = float(w[gap - 1].real + w[gap].real) / 2
            ends.append(RodAndLineAtEnd(float(whole.path_variable_values[at]), rod.coefficients, at_line))
            counts.append(count_right_of(at_line, rod).number if math.isfinite(at_line) else None)
        if None not in counts and max(end.line for end in ends) < 0 and ends[0].p != ends[1].p:
            count -= 1
            yield ends, whole.path.direction, counts


def wrong_proofs(proves, strips) -> tuple[int, int]:
    """(strips that are said to be crossed by none, and those of them whose ends count differently)."""
    proved = [counts for ends, direction, counts in strips if proves(*ends, direction, 2000)[0]]
    return len(proved), sum(a != b for a, b in proved)


@pytest.mark.long
def test_what_crosses_a_moving_line_is_never_overlooked():
    """Where the counts at both ends differ something crosses, in either direction of the path."""
    strips = list(random_strips(100))
    assert sum(a != b for _, _, (a, b) in strips) > 30
    proved, wrong = wrong_proofs(no_crossing_proof_and_count, strips)
    assert proved > 15
    assert wrong == 0
    for ends, direction, _ in strips:
        assert no_crossing_proof_and_count(*ends, direction, 2000) == no_crossing_proof_and_count(
            *ends[::-1], direction, 2000
        )


def holds_always(*words):
    return True


def no_width_in_p(at, y, direction, half, tilt):
    """The proof for the rod in the middle alone, which is what negative half-widths make of it."""
    return rectangle_proof_and_costs(at, y, direction, (half[0], 1e-12 * half[1]), 0.0)


@pytest.mark.parametrize(
    ("name", "broken"),
    [("is_taylor_remainder_below", holds_always), ("rectangle_proof_and_costs", no_width_in_p)],
    ids=["bound", "width"],
)
def test_a_broken_proof_is_noticed(monkeypatch, name, broken):
    """Without the remainder, or the width of a rectangle in p, strips are proved that counts refute."""
    monkeypatch.setattr(moving_line, "rectangle_proof_and_costs", rectangle_proof_and_costs.py_func)
    monkeypatch.setattr(moving_line, name, broken)
    _, wrong = wrong_proofs(no_crossing_proof_and_count.py_func, random_strips(20))
    assert wrong >= 3


@pytest.mark.parametrize("half", [(-1.0, 1.0), (1.0, -1.0), (0.0, 1.0), (1.0, math.nan)])
def test_rectangles_without_an_inside_are_refused(half):
    rod = Rod(F=30.0, k1=1e4, k2=1e4, gamma3=1e-4)
    at = RodAndLineAtEnd(30.0, rod.coefficients, -20.0)
    with pytest.raises(ValueError, match="half-widths of a rectangle must be above 0"):
        rectangle_proof_and_costs(at, 5.0, Coefficients(1.0, -1e-4, 0.0, 0.0), half, 0.0)


def test_what_is_proved_has_no_zero_inside():
    """Round what is said to be free of zeros the phase of D does not turn, at any of its rods."""
    rng, proved = np.random.default_rng(3), 0
    path = ParameterPath(Rod(F=30.0, k1=1e4, k2=1e3, gamma3=1e-3), "F")
    for _ in range(2000):
        p, at_line, y = rng.uniform(5, 60), -(10 ** rng.uniform(0, 5)), 10 ** rng.uniform(0, 5)
        half = (y * 10 ** rng.uniform(-2, -0.4), 10 ** rng.uniform(-3, 0.5))
        tilt = rng.normal() * at_line / 10
        at = RodAndLineAtEnd(p, path.rod_at(p).coefficients, at_line)
        if rectangle_proof_and_costs(at, y, path.direction, half, tilt)[0]:
            proved += 1
            for share in (-1, -0.3, 0.6, 1):
                rod = path.rod_at(p + share * half[1]).coefficients
                middle = at_line + share * tilt * half[1]
                corners = [complex(middle + 1e-3 * a * half[0], y + b * half[0]) for a, b in CORNERS]
                turn = [phase_change_by_nodes(a, b, rod)[0] for a, b in pairwise([*corners, corners[0]])]
                assert abs(sum(turn)) < 1
    assert proved > 300


def test_cubics_are_extrapolated_exactly():
    def cubic(x):
        return 2 - x + 3 * x**2 - 0.5 * x**3, -1 + 6 * x - 1.5 * x**2

    (a, slope_a), (b, slope_b) = cubic(1.0), cubic(1.5)
    for ahead in (0.5, 0.2, 1.3):
        assert extrapolate_hermite((a, b), (slope_a, slope_b), (0.5, ahead)) == pytest.approx(
            cubic(1.5 + ahead)[0]
        )


def test_coefficients_of_a_line_are_those_of_its_rods():
    for whole in LINES.values():
        rods = np.array([whole.rod_at(i).coefficients for i in range(len(whole))])
        assert np.array_equal(whole.coefficients, rods)


def test_a_double_eigenvalue_is_left_to_the_solver_of_single_points():
    onset = 20.0080206921031
    whole = line("F", onset + np.arange(-10, 10) * 0.01, k1=1e4, k2=1e4, gamma3=1e-4)
    found = solve_stretch(whole, REQUEST)
    alone = solve_spectrum(whole.rod_at(10), REQUEST)
    assert found.status[10] == alone.status == SpectrumStatus.accuracy_not_reached
    assert found.elements[10] == alone.elements > 0
    assert found.message[10] == alone.message
    others = np.delete(np.arange(20), 10)
    assert (found.elements[others] == 0).all()
    assert (found.status[others] == SpectrumStatus.ok).all()


def test_where_no_bound_applies_every_point_is_solved_alone():
    """A pull beyond the shear stiffness without drag: as uncertified as single points, bit by bit."""
    whole = line("F", np.linspace(-60, -30, 20), k1=1e4, k2=20.0, gamma3=0.0)
    found = solve_stretch(whole, REQUEST)
    assert not found.certified.any()
    for i in range(20):
        alone = solve_spectrum(whole.rod_at(i), REQUEST)
        assert found.status[i] == alone.status
        assert np.array_equal(found.eigenvalues[i], alone.eigenvalues, equal_nan=True)


def test_a_count_that_disagrees_stops_what_is_followed(monkeypatch):
    """Where no strip is proved every point is counted; where that fails too each point begins anew."""
    whole = line("F", np.linspace(10, 40, 12), k1=1e4, k2=1e4, gamma3=1e-4)
    usual = solve_stretch(whole, REQUEST)
    monkeypatch.setattr(neighbouring_rods, "last_point_with_carried_count", lambda *words: 0)
    counted = solve_stretch(whole, REQUEST)
    assert counted.certified.all()
    assert (counted.elements == 0).all()
    monkeypatch.setattr(neighbouring_rods, "count_right_of", lambda at, rod: SimpleNamespace(number=None))
    anew = solve_stretch(whole, REQUEST)
    assert anew.certified.all()
    for found in (counted, anew):
        assert np.allclose(found.eigenvalues, usual.eigenvalues, rtol=1e-12)
        assert np.array_equal(found.unstable_count, usual.unstable_count)
