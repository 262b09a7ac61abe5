"""The count of eigenvalues right of a line: right where it is given, refused where it cannot be."""

import numpy as np
import pytest
from rods import rod_of

from rodsweep.determinant.certificate.box_of_all_eigenvalues import box_of_all_eigenvalues
from rodsweep.determinant.certificate.dominance import (
    dominant_prefactor_and_exponent,
    has_dominant_exponential,
)
from rodsweep.determinant.certificate.winding_number import (
    count_right_of,
    phase_change,
    phase_change_by_nodes,
)
from rodsweep.determinant.value import scaled_determinant
from rodsweep.model.rod import Rod

CROWDED = Rod(F=2000.0, k1=1e4, k2=1e4, gamma3=1e-4)


def test_twelve_unstable_modes_where_fixed_steps_count_ten():
    assert count_right_of(-1.0, CROWDED).number == 12


def rod_and_eigenvalues(point):
    rod = rod_of(*(float(point[name]) for name in ("F", "k1", "k2", "gamma3")))
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
            for line in (-1e-5, 0.0):  # on the axis itself D is near 1 up to the foot of the line
                assert count_right_of(line, rod).number == point["unstable"], rod


def test_line_through_an_eigenvalue_is_refused(reference_spectra):
    for point in reference_spectra[::40]:
        rod, w = rod_and_eigenvalues(point)
        count = count_right_of(w[0].real, rod)
        assert count.number is None
        assert "too close" in count.failure_reason


@pytest.mark.long
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
    count = count_right_of(-1.0, Rod(F=-30.0, k1=1e4, k2=20.0, gamma3=0.0))
    assert count.number is None
    expected = "no a-priori bound on the eigenvalues applies to this rod at F = -30"
    assert count.failure_reason == expected


def test_box_holds_every_reference_eigenvalue(reference_spectra):
    for point in reference_spectra:
        rod, w = rod_and_eigenvalues(point)
        for value in w:
            real, imag = box_of_all_eigenvalues(rod, max(0.0, -value.real))
            assert value.real <= real
            assert abs(value.imag) <= imag


def test_box_is_nearly_sharp():
    """At k1 = k2 = 1e4, gamma3 = 1e-4, F = 2000 the rightmost eigenvalue has real part 965025.548182."""
    real, _ = box_of_all_eigenvalues(CROWDED)
    assert 965025 < real < 1.05e6


def random_rods(count):
    rng = np.random.default_rng(2718)
    for _ in range(count):
        k1, k2 = (10 ** rng.uniform(0, 12) if rng.random() < 0.8 else np.inf for _ in range(2))
        gamma3 = 10 ** rng.uniform(-14, 2) if rng.random() < 0.8 else 0.0
        force = rng.uniform(0, min(k1, 10 ** rng.uniform(0, 3.5)))
        yield (
            rng,
            Rod(F=force if rng.random() < 0.85 else -(10 ** rng.uniform(-2, 3)), k1=k1, k2=k2, gamma3=gamma3),
        )


def test_where_one_exponential_is_said_to_outweigh_the_rest_it_does():
    """|e| < 1 in D = A (1 + e), and the phase of what A is made of turns by less than a right angle."""
    proved = 0
    for rng, rod in random_rods(1000):
        for _ in range(10):
            w = 10 ** rng.uniform(0, 7) * np.exp(1j * rng.uniform(0, np.pi))
            rho = abs(w) * rng.choice([0.25, 0.12, 0.06, 0.02])
            if not has_dominant_exponential(w, rho, rod.coefficients):
                continue
            proved += 1
            factor_here, root_here = dominant_prefactor_and_exponent(w, rod.coefficients)
            for angle in rng.uniform(0, 2 * np.pi, 4):
                there = w + rho * np.exp(1j * angle)
                factor, root = dominant_prefactor_and_exponent(there, rod.coefficients)
                D, _, S, _ = scaled_determinant(there, rod.coefficients)
                A = factor / 4 * np.exp(1j * root.imag + root.real - S)
                assert abs(D / A - 1) < 1, (rod, w, rho)
                assert abs(np.angle(factor / factor_here)) < np.pi / 2
                assert (root * np.conj(root_here)).real > 0
    assert proved > 4000


def test_long_strides_give_the_phase_of_short_steps():
    for rng, rod in random_rods(400):
        if rod.F < 0:
            continue
        real, imag = box_of_all_eigenvalues(rod, 1.0)
        corner, end = complex(real, imag), complex(-(10 ** rng.uniform(0, 4)), imag)
        for start, stop in ((complex(real, 0.0), corner), (end, corner)):
            change, used = phase_change(start, stop, rod.coefficients)
            stepped, nodes = phase_change_by_nodes(start, stop, rod.coefficients)
            assert (used > 0) == (nodes > 0)
            assert change == pytest.approx(stepped, abs=1e-9), rod


def test_few_nodes_suffice_on_the_paper_s_rods():
    nodes = [
        count_right_of(-3000.0, Rod(F=force, k1=k1, k2=k2, gamma3=gamma3)).node_count
        for k1, k2, gamma3, top in ((1e4, 1e4, 1e-4, 60), (1e4, 1e2, 1e-2, 45), (2e2, 1e4, 1e-4, 180))
        for force in np.linspace(0.1, 1.0, 5) * top
    ]
    assert np.median(nodes) < 40


def test_nothing_outweighs_between_the_eigenvalues(reference_spectra):
    """A disc that contains an eigenvalue is never said to be dominated."""
    for point in reference_spectra:
        rod, w = rod_and_eigenvalues(point)
        for root in w:
            for rho in (0.01, 0.1, 0.3):
                for turn in (1, 1j, -1, -1j):
                    centre = root + 0.99 * rho * abs(root) * turn
                    assert not has_dominant_exponential(centre, rho * abs(root), rod.coefficients)
