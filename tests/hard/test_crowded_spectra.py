"""Many unstable modes, soft shear (k2 below 10), strong rotational drag (gamma3 of 10 and more).

Known exactly: the number of unstable modes, by two dense meshes of an independent discretisation, and every
one of them to 30 digits. A pair grows more slowly than the most amplified wave, by which all real parts are
bounded, so in long soft rods they crowd below it: their real parts agree in several digits.
"""

import numpy as np
import pytest
from rods import rod_of

from rodsweep.determinant.certificate.winding_number import count_right_of
from rodsweep.solve.spectrum.status import SpectrumStatus

from .exact import candidates, leading, unstable
from .integral_equation import fastest_wave
from .promises import broken_promises, not_ok, spectrum, true_errors
from .rods import CROWDED


@pytest.mark.long
@pytest.mark.kernel
@pytest.mark.parametrize("rod", CROWDED, ids=str)
def test_all_unstable_modes_are_counted_and_found_to_twelve_digits(rod):
    number = CROWDED[rod]
    assert unstable(rod) == number
    modes = number + 2
    assert broken_promises(rod, modes) == []
    assert not_ok([rod], modes) == []
    assert spectrum(rod, modes).unstable_count == number
    assert (true_errors(rod, modes) / abs(spectrum(rod, modes).eigenvalues)).max() < 1e-12


@pytest.mark.parametrize("modes", [1, 2, 3])
@pytest.mark.parametrize("rod", CROWDED, ids=str)
def test_few_of_many_unstable_modes_are_the_leading_ones_and_all_are_counted(rod, modes):
    found = spectrum(rod, modes)
    assert broken_promises(rod, modes) == []
    assert (found.status, found.unstable_count) == (SpectrumStatus.ok, CROWDED[rod])


@pytest.mark.parametrize("rod", CROWDED, ids=str)
def test_the_count_right_of_any_line_between_unstable_modes_is_right(rod):
    w = candidates(rod, CROWDED[rod])
    right = 0
    for i in range(0, min(len(w), CROWDED[rod] + 2) - 2, 2):
        if w[i + 1].real - w[i + 2].real > 1e-4 * abs(w[i]):
            line = (w[i + 1].real + w[i + 2].real) / 2
            assert count_right_of(line, rod_of(*rod)).number == i + 2
            right += 1
    assert right >= CROWDED[rod] // 2


@pytest.mark.parametrize(("k2", "gap"), [(0.1, 4e-2), (0.01, 3e-3), (0.003, 1e-3)])
def test_two_pairs_with_nearly_equal_real_parts_are_told_apart(k2, gap):
    """The softer the shear, the more waves along the rod, and the closer the leading pairs to the fastest."""
    rod = (20.0, 1e3, k2, 10.0)
    found, exact = spectrum(rod), leading(rod, 4)
    assert found.status == SpectrumStatus.ok
    assert gap / 2 < 1 - exact[2].real / exact[0].real < gap
    assert relative(found.eigenvalues, exact) < 1e-12
    assert found.eigenvalues[1] == found.eigenvalues[0].conjugate()
    assert found.eigenvalues[3] == found.eigenvalues[2].conjugate()


def relative(found, exact):
    """Each with its own, and not with the nearest: a wrong order does not pass."""
    return max(float(abs(complex(w) - x) / abs(x)) for w, x in zip(found, exact, strict=True))


def test_no_eigenvalue_reaches_the_most_amplified_wave():
    for rod, number in CROWDED.items():
        real = np.array([float(w.real) for w in leading(rod, number + 2)])
        assert (real < fastest_wave(rod)[0] * (1 + 1e-3)).all()
