"""Spectra by rodsweep in the benchmark of spectra; names, numbers and a table for all methods."""

from collections.abc import Callable, Iterable

import numpy as np

from ...arrays import Complex
from ...model.rod import Rod
from ...solve.spectrum.search import SpectrumRequest, solve_spectrum
from ..study import Measurement, grouped_by_fields, markdown_table

MODE_COUNT = 4
"""Number of leading eigenvalues that every method computes."""
SPECTRUM_ACCURACY = 1e-12
"""Relative accuracy requested from rodsweep; the error of the eigenvalues does not depend on this request."""
UNCERTIFIED_NAME = "rodsweep, certificate off"
"""Name of rodsweep without certificate in the tables."""
CERTIFIED_NAME = "rodsweep, certificate on"
"""Name of rodsweep with certificate in the tables."""
KRYLOV_SCHUR = "Krylov-Schur alone, same pencil"
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
