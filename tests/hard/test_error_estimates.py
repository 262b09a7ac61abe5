"""The error estimate over every hard spectrum of this directory, at three accuracies.

Promised always: an error is at most ten estimates. Where the status is ok: at most the accuracy asked for,
and the estimate at most ten errors, or what rounding may do to the eigenvalue (`hard.promises`).
"""

from functools import cache
from math import inf

import numpy as np
import pytest

from rodsweep.solve.spectrum.status import SpectrumStatus

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
