"""True numbers of straight rods: eigenvalues, and where they change, from both sides of a stated place."""

from dataclasses import replace

import numpy as np
from rods import rod_of

from rodsweep.determinant.parameter_path import ParameterPath
from rodsweep.model.parameters import NON_OPTIONAL_LINEAR_PARAMETER_NAMES
from rodsweep.model.rod import Rod
from rodsweep.solve.changes.thresholds_along_path import find_thresholds
from rodsweep.solve.spectrum.search import SpectrumRequest, solve_spectrum
from rodsweep.sweep.points.points import lines_along

BESIDE = 1e-7
"""Relative distance from a stated threshold at which eigenvalues are computed on both its sides."""
EXACT = SpectrumRequest(2, 1e-11, True)
SHORT_OF_CRUSHED = 1 - 1e-6


def rods_of(view):
    """The rod of every point, in their order."""
    columns = view.point_columns
    rows = zip(*(columns[name] for name in NON_OPTIONAL_LINEAR_PARAMETER_NAMES), strict=True)
    return [rod_of(*map(float, row)) for row in rows]


def leading(rod):
    """(leading eigenvalue, the next one)."""
    w = solve_spectrum(rod, EXACT).eigenvalues
    return complex(w[0]), complex(w[1])


def time_is_known(view):
    """Whether the time of the largest growth is known to a half of itself, at every point.

    Between 0 and twice that time the growth is a parabola about, from 1 up and back.
    """
    v = view.variables
    return v["growth_error"] < (1 - 1 / v["transient_growth"]) / 4


def is_change(rod, name, at, kind):
    """Whether the straight rod changes in this way where a parameter has a value."""
    before, after = (leading(replace(rod, **{name: at + side * BESIDE * abs(at)})) for side in (-1, 1))
    if kind == "onset":
        return before[0].imag == before[1].imag == 0 and after[0].imag > 0
    signs = {"hopf": (-1, 1), "restabilization": (1, -1)}[kind]
    return tuple(np.sign([before[0].real, after[0].real])) == signs


def changes_along(rod, name, low, high):
    """All that changes between two values of a parameter."""
    return find_thresholds(ParameterPath(rod, name), low, high).thresholds


def changes_over_force(rod, top):
    """All that changes from F = 0 up to a force, or to where the rod is crushed."""
    return changes_along(rod, "F", 0.0, min(top, rod.k1 * SHORT_OF_CRUSHED))


def changes_on_lines(view, name):
    """(rod, crossing, points) of every change of stability and onset on the lines over a parameter."""
    found = []
    for line in lines_along(view.point_columns, name):
        low, high = float(line.values.min()), float(line.values.max())
        low = min(low, 0.0) if name == "F" and view.task == "limit_cycle" and low < high else low
        rod = Rod(**{n: line.other_parameters.get(n, low) for n in NON_OPTIONAL_LINEAR_PARAMETER_NAMES})
        for crossing in changes_along(rod, name, low, high) if low < high else ():
            kind, after = crossing.kind.name, crossing.unstable_after
            if kind == "onset" or (kind, after) in (("hopf", 2), ("restabilization", 0)):
                found.append((rod, crossing, line.indices))
    return found


def changes_of(view, name):
    """(rod, kind, value, frequency) of all these."""
    return [(rod, c.kind.name, c.value, c.frequency) for rod, c, _ in changes_on_lines(view, name)]
