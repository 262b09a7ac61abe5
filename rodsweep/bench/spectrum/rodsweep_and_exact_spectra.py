"""Benchmark of spectra: the spectra by rodsweep, the table of all methods, and reference eigenvalues to 30
digits. The reference eigenvalues are roots of D in multiple precision (mpmath), proved complete by the
certificate."""

from collections.abc import Callable, Iterable
from typing import Any

import mpmath as mp
import numpy as np

from ...arrays import Complex
from ...model.rod import Rod
from ...solve.spectrum.search import SpectrumRequest, solve_spectrum
from ...solve.spectrum.status import SpectrumStatus
from ..study import Measurement, grouped_by_fields, markdown_table

MODE_COUNT = 4
"""Number of leading eigenvalues that every method computes."""
SPECTRUM_ACCURACY = 1e-12
"""Relative accuracy requested from rodsweep; the error of the eigenvalues does not depend on this request."""
UNCERTIFIED_NAME = "rodsweep, certificate off"
"""Name of rodsweep without certificate in the tables."""
CERTIFIED_NAME = "rodsweep, certificate on"
"""Name of rodsweep with certificate in the tables."""
KRYLOV_SCHUR_NAME = "Krylov-Schur alone, same pencil"
"""Name of SLEPc's Krylov-Schur on rodsweep's pencil in the tables."""
RODSWEEP_GROUP, PENCIL_GROUP = "this tool", "the same pencil"
"""Groups of methods in the figure: rodsweep, and eigensolvers on rodsweep's pencil."""


def rodsweep_spectrum(rod: Rod, certify: bool) -> Complex:
    """Leading eigenvalues, (modes,), of a rod by rodsweep, with a mesh chosen by rodsweep. certify: whether
    to prove the list of eigenvalues complete."""
    return solve_spectrum(rod, SpectrumRequest(MODE_COUNT, SPECTRUM_ACCURACY, certify)).eigenvalues


def leading_eigenvalues(w: Complex, count: int) -> Complex:
    """The `count` eigenvalues with the largest real parts, by descending real part, (count,). w: eigenvalues,
    (n,)."""
    return w[np.argsort(-w.real, kind="stable")][:count]


def table_by_case(
    cases: Iterable[str], measurements: Iterable[Measurement], cell: Callable[[list[Measurement]], str]
) -> str:
    """Table in Markdown with a row for each method and a column for each of the `cases`. cell: function from
    the measurements of a method on a case, at all settings, to the text of a cell."""
    rows = [
        {"method": method, "cells": " | ".join(map(cell, grouped_by_fields(measured, "case").values()))}
        for (method,), measured in grouped_by_fields(measurements, "method").items()
    ]
    return markdown_table(" | ".join(["method", *cases]), "{method} | {cells}", rows)


CORRECT_DIGIT_COUNT = 30
"""Number of correct decimal digits of the eigenvalues."""
GUARD_DIGIT_COUNT = 25
"""Number of additional digits in the computation, more than are lost by cancellation in D."""
RELATIVE_SECANT_STEP = mp.mpf(10) ** -12
"""Relative distance between the two starting points of the secant method."""
MAX_ROOT_DISTANCE_IN_ERRORS = 20
"""Largest distance of a root from its starting value, divided by the estimated error of the starting value; a
root at a larger distance is a different root."""


def multiprecision_determinant(rod: Rod) -> Callable[[Any], Any]:
    """The characteristic determinant D of a rod as a function of w, in multiple precision (mpmath), defined
    as in `rodsweep.determinant.value`. The parameters of the rod are taken as exact."""
    F = mp.mpf(rod.F)
    gamma3 = mp.mpf(rod.gamma3)
    c1, c2 = (0 if np.isinf(k) else 1 / mp.mpf(k) for k in (rod.k1, rod.k2))
    nu = 1 - F * c1
    g = nu + F * c2

    def term(z: Any, slope: Any) -> Any:
        return slope * (mp.cosh(mp.sqrt(z)) - 1) / z

    def D(w: Any) -> Any:
        P = mp.sqrt(w * (g * nu + c2 * gamma3 * w))
        slope = (g * nu + 2 * c2 * gamma3 * w) / (2 * P)
        middle = (c2 + gamma3) * w - F * g
        drag = c2 + gamma3
        return 1 + w / 2 * (term(middle + 2 * P, drag + 2 * slope) + term(middle - 2 * P, drag - 2 * slope))

    return D


def exact_spectrum(rod: Rod, mode_count: int) -> list[Any]:
    """The `mode_count` leading eigenvalues of a rod to CORRECT_DIGIT_COUNT digits, as numbers of mpmath.

    Raises ArithmeticError if the list of eigenvalues is not certified, or if no root of D is found near an
    eigenvalue.
    """
    spectrum = solve_spectrum(rod, SpectrumRequest(mode_count, 1e-11, certify=True))
    if spectrum.status != SpectrumStatus.ok or not spectrum.certified:
        raise ArithmeticError(f"{rod}: {spectrum.status.name} {spectrum.message}")
    roots = []
    with mp.workdps(CORRECT_DIGIT_COUNT + GUARD_DIGIT_COUNT):
        D = multiprecision_determinant(rod)
        for w, error in zip(spectrum.eigenvalues, spectrum.error_estimate, strict=True):
            start = mp.mpc(complex(w))
            root = mp.findroot(
                D, (start, start * (1 + RELATIVE_SECANT_STEP)), tol=RELATIVE_SECANT_STEP**5, verify=False
            )
            # Near a simple root |D| is proportional to the distance: the limit is |D| at the relative
            # distance 10^-CORRECT_DIGIT_COUNT.
            rounding_limit = (
                abs(D(root * (1 + RELATIVE_SECANT_STEP)))
                * mp.mpf(10) ** -CORRECT_DIGIT_COUNT
                / RELATIVE_SECANT_STEP
            )
            if abs(root - start) > MAX_ROOT_DISTANCE_IN_ERRORS * error or abs(D(root)) > rounding_limit:
                raise ArithmeticError(f"{rod}: {complex(w)} does not lead to a root of D")
            roots.append(root)
    return roots


def relative_error(w: Complex | Exception, exact: list[Any]) -> float:
    """Largest relative distance of an exact eigenvalue from the nearest computed eigenvalue; inf if w is
    empty or an exception of the solver. w: computed eigenvalues, (modes,)."""
    if isinstance(w, Exception) or not len(w):
        return float("inf")
    with mp.workdps(CORRECT_DIGIT_COUNT):
        computed = [mp.mpc(complex(value)) for value in w]
        return max(float(min(abs(value - root) for value in computed) / abs(root)) for root in exact)


def error_as_measurement_field(exact: list[Any], w: Complex) -> dict[str, float]:
    """The relative error of computed eigenvalues w, (modes,), as field `error` of a `Measurement`."""
    return {"error": relative_error(w, exact)}
