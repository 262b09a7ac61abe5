"""F at a Hopf point to all digits that a float has: a pair lies on the imaginary axis within rounding.

Known exactly: the Hopf points of `tests/reference/thresholds.json` to 30 digits, and how many modes are
unstable to either side. At the point itself nobody can say which, and a relative 1e-9 off everybody can.
"""

import pytest
from rods import rod_of
from surveyed import RODS

from rodsweep.determinant.certificate.winding_number import count_right_of
from rodsweep.solve.modes.leading_modes import ModesRequest, solve_modes
from rodsweep.solve.spectrum.status import SpectrumStatus

from .promises import spectrum
from .rods import CROSSING, STORED, at_force

CROSSINGS = [
    (float(rod["k1"]), float(rod["k2"]), float(rod["gamma3"]), event)
    for rod in STORED
    for event in [e for e in rod["events"] if e["kind"] in CROSSING][:3]
]


def sides(event):
    """(unstable modes below the force, above it)"""
    after = event["unstable_after"]
    return (after - 2, after) if event["kind"] == "hopf" else (after + 2, after)


def test_a_rod_at_a_hopf_point_is_undecided():
    assert len(CROSSINGS) > 90
    for *rod, event in CROSSINGS:
        found = spectrum(at_force(event["F"], 0, *rod))
        assert (found.status, found.unstable_count, found.certified) == (
            SpectrumStatus.undecided,
            -1,
            False,
        ), rod
        there = found.eigenvalues[abs(found.eigenvalues.real).argmin()]
        if abs(there.real) < 1e-9 * abs(there):  # unless other unstable modes lead
            assert abs(there.imag) == pytest.approx(float(event["frequency"]), rel=1e-11)


@pytest.mark.parametrize("offset", [1e-9, -1e-9])
def test_a_billionth_beside_a_hopf_point_the_count_is_right_and_proved(offset):
    """Or refused, which may happen where other pairs leave no room for a line, but seldom."""
    proved = 0
    for *rod, event in CROSSINGS:
        found = spectrum(at_force(event["F"], offset, *rod))
        assert found.unstable_count in (-1, sides(event)[offset > 0]), (rod, event)
        assert found.certified == (found.status == SpectrumStatus.ok)
        proved += found.certified
    assert proved >= 0.9 * len(CROSSINGS)


@pytest.mark.long
@pytest.mark.parametrize("offset", [1e-11, 1e-12, 1e-13, 1e-14, 1e-15])
def test_however_near_a_hopf_point_the_count_is_never_wrong(offset):
    for *rod, event in CROSSINGS[::3]:
        for sign in (1, -1):
            found = spectrum(at_force(event["F"], sign * offset, *rod))
            assert found.unstable_count in (-1, sides(event)[sign > 0]), (rod, event)
            assert found.status in (SpectrumStatus.ok, SpectrumStatus.undecided, SpectrumStatus.not_certified)


def test_the_winding_number_along_the_axis_is_refused_where_a_pair_lies_on_it():
    for *rod, event in CROSSINGS[:: 3 if RODS else 12]:
        assert count_right_of(0.0, rod_of(*at_force(event["F"], 0, *rod))).number is None
        for offset in (1e-9, -1e-9):
            beside = count_right_of(0.0, rod_of(*at_force(event["F"], offset, *rod))).number
            assert beside in (None, sides(event)[offset > 0])


def test_modes_at_a_hopf_point_are_given_but_whether_they_grow_is_undecided():
    for *rod, event in CROSSINGS[:3]:
        found = solve_modes(rod_of(*at_force(event["F"], 0, *rod)), ModesRequest(2, 1e-8, 9, True))
        assert (found.status, found.spectrum.unstable_count) == (SpectrumStatus.undecided, -1)
        assert found.mode_vectors.condition_error.max() < 1e-8
