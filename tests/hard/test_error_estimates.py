"""The error estimate over every hard spectrum of this directory, at three accuracies.

Promised always: an error is at most ten estimates. Where the status is ok: at most the accuracy asked for,
and the estimate at most ten errors, or what rounding may do to the eigenvalue (`hard.promises`).
"""

from functools import cache
from math import inf

import numpy as np
import pytest
from followed_lines import line

from rodsweep.solve.spectrum.path.neighbouring_rods import follow_spectra
from rodsweep.solve.spectrum.search import SpectrumRequest
from rodsweep.solve.spectrum.status import SpectrumStatus

from .exact import leading
from .limits import EPSILONS, PATHS, rod_on
from .promises import all_broken, spectrum, true_errors
from .rods import (
    BESIDE,
    COINCIDENT,
    CROWDED,
    CRUSHED,
    EXCEPTIONAL,
    PARTIAL_BEAMS,
    at_force,
    coincident,
    crushed,
)

FAMILIES = {
    "exceptional": lambda: [at_force(e["F"], d, *rod) for *rod, e in EXCEPTIONAL for d in (0, *BESIDE[::3])],
    "crushed": lambda: [rod for parameters in CRUSHED for rod in crushed(*parameters)[::2]],
    "partial beams": lambda: [rod for k1 in PARTIAL_BEAMS for rod in crushed(k1, inf, 0.0, 6)],
    "limits": lambda: [rod_on(path, epsilon) for path in PATHS for epsilon in (0.0, *EPSILONS[::2])],
    "crowded": lambda: list(CROWDED),
    "coincident": lambda: [
        (*rod, float(coincident(*rod, guess) * (1 + d)))
        for rod, guess, _ in COINCIDENT
        for d in (0, 1e-10, 1e-5)
    ],
}


@cache
def rods_of(family):
    return FAMILIES[family]()


@pytest.mark.parametrize("accuracy", [1e-12, 1e-8, 1e-4])
@pytest.mark.parametrize("family", FAMILIES)
def test_every_error_estimate_of_a_hard_spectrum_is_honest(family, accuracy):
    assert all_broken(rods_of(family), accuracy=accuracy) == []


@pytest.mark.parametrize("family", FAMILIES)
def test_hard_spectra_are_ok_where_a_millionth_is_asked_for(family):
    """None of what makes these rods hard costs ten digits, but F* itself."""
    for rod in rods_of(family):
        found = spectrum(rod, 4, 1e-6)
        assert found.certified, rod
        assert found.status == SpectrumStatus.ok, rod


def test_estimates_are_of_the_size_of_the_errors():
    """In the median over all hard eigenvalues the estimate is between a half and ten errors."""
    ratios = []
    for family in FAMILIES:
        for rod in rods_of(family):
            size = abs(spectrum(rod).eigenvalues)
            error = true_errors(rod)
            seen = error > 1e-16 * size
            ratios.extend((spectrum(rod).error_estimate[seen] / error[seen]).tolist())
    assert len(ratios) > 500
    assert 0.5 < np.median(ratios) < 10


NEAR_DOUBLE = [
    (27.650479537560066, 100.17885555807581, 41549.47905608765, 9.945076554201247e-06),
    (16.98064423886779, 2324.5318579506766, 156.44664552370142, 0.0011189958767792096),
    (20.906774492028223, 134.3666844408234, 306.2531179417475, 0.00044160336476925597),
    (15.965218668501318, 36061.889207962085, 108.70413208544171, 0.0012761570936722173),
]
"""Rods (F, k1, k2, gamma3) near F*, whose errors were 1.9 to 2.5 estimates with the typical rounding of D."""


@pytest.mark.parametrize("rod", NEAR_DOUBLE, ids=lambda rod: f"F={rod[0]:.3f}")
def test_near_a_double_eigenvalue_no_error_is_larger_than_its_estimate(rod):
    found = spectrum(rod, 4, 1e-8)
    error = true_errors(rod, 4, 1e-8)
    assert (error <= found.error_estimate).all()
    assert (found.error_estimate <= 1e-6 * abs(found.eigenvalues)).all()


FOLLOWED_NEAR_DOUBLE = [
    (18.9924110, 2e-4, 202923.4997221758, 862.123797543841, 0.0020173078273204963),
    (21.8675217, 4e-6, 258.9824606968212, 24559.182468372834, 0.0),
    (20.8186949, 5e-5, 535.0493374404602, 15917.057031859302, 2.1820562278654372e-06),
]
"""(F, half the relative width in F, k1, k2, gamma3) of lines close to F*, whose followed eigenvalues had
errors of 1.7 to 2.3 estimates with the typical rounding of D."""


@pytest.mark.parametrize("case", FOLLOWED_NEAR_DOUBLE, ids=lambda case: f"F={case[0]:.3f}")
def test_followed_near_a_double_eigenvalue_no_error_is_larger_than_its_estimate(case):
    F, half_width, k1, k2, gamma3 = case
    rods = line("F", F * (1 + np.linspace(-half_width, half_width, 40)), k1=k1, k2=k2, gamma3=gamma3)
    followed = follow_spectra(rods, SpectrumRequest(2, 1e-8, True))
    assert followed.is_solved.sum() > 30
    ratios = []
    for i in np.flatnonzero(followed.is_solved):
        exact = leading((float(rods.parameter_values[i]), k1, k2, gamma3), 2)
        for w, estimate, root in zip(
            followed.spectra.eigenvalues[i], followed.spectra.error_estimate[i], exact, strict=True
        ):
            ratios.append(float(abs(complex(w) - root)) / estimate)
    assert max(ratios) <= 1
    assert np.median(ratios) > 0.05
