"""The count of eigenvalues right of a line: right where it is given, refused where it cannot be."""

import numpy as np
import pytest

from rodsweep.model.bounds import eigenvalue_box
from rodsweep.model.rod import Rod
from rodsweep.solve.certificate import count_right_of

CROWDED = Rod(2000.0, 1e4, 1e4, 1e-4)


def test_twelve_unstable_modes_where_fixed_steps_count_ten():
    assert count_right_of(-1.0, CROWDED).number == 12


def rod_and_eigenvalues(point):
    rod = Rod(*(float(point[name]) for name in ("F", "k1", "k2", "gamma3")))
    return rod, np.array([complex(float(re), float(im)) for re, im in point["eigenvalues"]])


def test_counts_agree_with_proved_ones_between_all_listed_eigenvalues(reference_spectra):
    """466 rods, a line in every gap of 1e-3 or more: the count is the number of eigenvalues before it."""
    lines = 0
    for point in reference_spectra:
        if not point["proven"]:
            continue
        rod, w = rod_and_eigenvalues(point)
        for i in range(1, len(w)):
            right, left = w[i - 1].real, w[i].real
            if right - left > 1e-3 * abs(left):
                assert count_right_of((left + right) / 2, rod).number == i, (rod, i)
                lines += 1
    assert lines > 1500


def test_unstable_counts_agree_with_proved_ones(reference_spectra):
    for point in reference_spectra:
        rod, w = rod_and_eigenvalues(point)
        if point["proven"] and np.abs(w.real).min() > 1e-4:
            assert count_right_of(-1e-5, rod).number == point["unstable"], rod


def test_line_through_an_eigenvalue_is_refused(reference_spectra):
    for point in reference_spectra[::40]:
        rod, w = rod_and_eigenvalues(point)
        count = count_right_of(w[0].real, rod)
        assert count.number is None
        assert "too close" in count.why_not


@pytest.mark.parametrize("offset", [1e-4, -1e-4, 1e-6, -1e-6])
def test_line_beside_an_eigenvalue_is_decided_rightly(offset, reference_spectra):
    decided = 0
    for point in reference_spectra[::20]:
        rod, w = rod_and_eigenvalues(point)
        if not point["proven"]:
            continue
        line = w[0].real + offset * abs(w[0])
        count = count_right_of(line, rod).number
        assert count in (None, int((w.real > line).sum())), rod
        decided += count is not None
    assert decided >= 20


def test_no_bound_no_count():
    """A pull beyond the shear stiffness without rotational drag has no a-priori bound."""
    count = count_right_of(-1.0, Rod(-30.0, 1e4, 20.0, 0.0))
    assert count.number is None
    assert "bound" in count.why_not


def test_box_holds_every_reference_eigenvalue(reference_spectra):
    for point in reference_spectra:
        rod, w = rod_and_eigenvalues(point)
        for value in w:
            real, imag = eigenvalue_box(rod, max(0.0, -value.real))
            assert value.real <= real
            assert abs(value.imag) <= imag


def test_box_is_nearly_sharp():
    """At k1 = k2 = 1e4, gamma3 = 1e-4, F = 2000 the rightmost eigenvalue has real part 965025.548182."""
    real, _ = eigenvalue_box(CROWDED)
    assert 965025 < real < 1.05e6
