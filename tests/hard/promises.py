"""What every spectrum promises, whatever its status, held against the exact one."""

from functools import cache

import mpmath as mp
import numpy as np
from rods import rod_of

from rodsweep.solve.spectrum.search import SpectrumRequest, solve_spectrum
from rodsweep.solve.spectrum.status import SpectrumStatus

from .exact import leading, sensitivity, unstable

TIE = 1e-9
"""Relative distance of real parts below which the order of two modes is left to rounding."""
AN_EIGENVALUE_AS_A_DOUBLE = 2.3e-16
"""Relative: half a unit in the last place of both of its parts, which no estimate need cover."""
FULL_DIGITS = 1e-14
"""Relative error, times the eigenvalue's sensitivity to the force where that exceeds one, below which
rounding may by luck have left less than a tenth of the estimate."""


@cache
def spectrum(rod, modes=4, accuracy=1e-12):
    return solve_spectrum(rod_of(*rod), SpectrumRequest(modes, accuracy, True))


@cache
def true_errors(rod, modes=4, accuracy=1e-12):
    """|found - exact|, shape (modes,): each found eigenvalue is compared with the nearest one not yet taken.

    One that is missing, or given twice, leaves another without its own, whatever the order of equals.
    """
    exact = leading(rod, modes + 2)
    last, errors = exact[modes - 1], []
    left = [w for i, w in enumerate(exact) if i < modes or abs(mp.re(w - last)) < TIE * abs(last)]
    for w in spectrum(rod, modes, accuracy).eigenvalues:
        if not np.isfinite(w):
            errors.append(np.nan)
            continue
        with mp.workdps(40):
            distances = [abs(mp.mpmathify(complex(w)) - x) for x in left]
            nearest = int(np.argmin(distances))
            errors.append(float(distances[nearest]))
        left.pop(nearest)
    return np.array(errors)


def broken_promises(rod, modes=4, accuracy=1e-12):
    """One sentence for each promise that the spectrum of a rod breaks."""
    found, error = spectrum(rod, modes, accuracy), true_errors(rod, modes, accuracy)
    size, estimate = abs(found.eigenvalues), found.error_estimate
    given = np.isfinite(found.eigenvalues)
    broken = []
    if (error > 10 * estimate + AN_EIGENVALUE_AS_A_DOUBLE * size)[given].any():
        broken.append("an error is larger than ten estimates")
    if (np.diff(found.eigenvalues.real) > 0).any():
        broken.append("the modes are out of order")
    if found.unstable_count not in (-1, unstable(rod)):
        broken.append(f"{found.unstable_count} modes are not unstable, but {unstable(rod)}")
    if found.certified and found.unstable_count < 0:
        broken.append("certified without a count")
    if found.status == SpectrumStatus.ok:
        if not found.certified:
            broken.append("ok without a proof")
        if not (error <= accuracy * size).all():
            broken.append("ok, but less accurate than asked for")
        if any(
            _exaggerates(*numbers, rod) for numbers in zip(found.eigenvalues, estimate, error, strict=True)
        ):
            broken.append("an estimate is larger than ten errors")
    if not broken:
        return []
    numbers = f"relative errors {error / size}, estimates {estimate / size}, {found.eigenvalues}"
    return [f"{rod} x{modes} {accuracy} ({found.status.name}): {what}; {numbers}" for what in broken]


def _exaggerates(w, estimate, error, rod):
    """Whether an estimate is larger than ten errors, and larger than what rounding explains."""
    if estimate <= 10 * max(error, FULL_DIGITS * abs(w)):
        return False
    return estimate > 10 * FULL_DIGITS * abs(w) * sensitivity(complex(w), rod)


def all_broken(rods, modes=4, accuracy=1e-12):
    """The broken promises of many rods, to be compared with []."""
    return [sentence for rod in rods for sentence in broken_promises(rod, modes, accuracy)]


def not_ok(rods, modes=4, accuracy=1e-12):
    """Rods whose status is not ok, with status and message, to be compared with []."""
    results = {rod: spectrum(rod, modes, accuracy) for rod in rods}
    return [
        f"{rod}: {r.status.name} {r.message}" for rod, r in results.items() if r.status != SpectrumStatus.ok
    ]
