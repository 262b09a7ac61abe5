"""Lines through the space of rods, and the comparison of followed spectra with single points."""

from dataclasses import dataclass, field

import numpy as np

from benchmarks.lapack import inverse_spectrum, whole_matrices
from rodsweep.determinant.certificate.box_of_all_eigenvalues import box_of_all_eigenvalues
from rodsweep.determinant.parameter_path import ParameterPath
from rodsweep.discretization.elements.resolution import expected_wave_number, resolution_for
from rodsweep.model.dispersion import largest_growth_and_wave_number
from rodsweep.model.rod import Rod
from rodsweep.solve.spectrum.path.neighbouring_rods import NeighbouringRods, follow_spectra
from rodsweep.solve.spectrum.search import Spectrum, SpectrumRequest, solve_spectrum
from rodsweep.solve.spectrum.status import SpectrumStatus
from rodsweep.sweep.points.groups import MAX_GROUP_POINTS

LARGEST = 400
"""Unknowns up to which whole matrices are solved."""
FEWEST_MODES = 8
"""For which a mesh is chosen at first."""
CLEAR = 1e-6
"""Distance from the imaginary axis, in units of the box, in which a dense solver cannot count."""


def line(name: str, values, **others: float) -> NeighbouringRods:
    """Rods that differ in one parameter."""
    values = np.asarray(values, float)
    return NeighbouringRods(ParameterPath(Rod(**others, **{name: values[0]}), name), values)


def parts(whole: NeighbouringRods) -> list[NeighbouringRods]:
    """A line cut as a sweep cuts it."""
    return [
        NeighbouringRods(whole.path, whole.parameter_values[at : at + MAX_GROUP_POINTS])
        for at in range(0, len(whole), MAX_GROUP_POINTS)
    ]


def random_line(rng: np.random.Generator) -> NeighbouringRods:
    """A line of 8 to 64 rods along any parameter: soft, rigid, pulled, nearly crushed, without drag."""
    k1, k2 = (10 ** rng.uniform(0, 6) if rng.random() < 0.8 else np.inf for _ in range(2))
    gamma3 = 10 ** rng.uniform(-8, 1) if rng.random() < 0.7 else 0.0
    F = min(0.999 * k1, 10 ** rng.uniform(0, 3)) * (1 if rng.random() < 0.9 else -1)
    name, n = str(rng.choice(["F", "k1", "k2", "gamma3"])), int(rng.integers(8, MAX_GROUP_POINTS + 1))
    if name == "F":
        values = np.linspace(F * rng.uniform(-0.1, 0.9), F, n)
    else:
        low = {
            "k1": max(1.0001 * F, 1.0),
            "k2": 10 ** rng.uniform(0.5, 4),
            "gamma3": 10 ** rng.uniform(-8, -1),
        }
        values = np.geomspace(low[name], low[name] * 10 ** rng.uniform(0.05, 3), n)
        if rng.random() < 0.2:
            values[0 if name == "gamma3" else -1] = 0.0 if name == "gamma3" else np.inf
    rod = {"F": F, "k1": k1, "k2": k2, "gamma3": gamma3} | {name: np.unique(values)}
    return line(name, rod.pop(name), **rod)


def dense_count(rod: Rod) -> int | None:
    """Unstable modes by LAPACK on the whole matrices, right of the axis by more than it can err; or None.

    By LU and geev: where F is several times k2, QZ's finite eigenvalues are wrong on every mesh. The mesh is
    one for at least as many modes as are counted.
    """
    real, imag = box_of_all_eigenvalues(rod)
    _, wave = largest_growth_and_wave_number(rod)
    count, modes = FEWEST_MODES, 0
    while count > modes:
        modes = count
        mesh = resolution_for(1.3 * expected_wave_number(modes, wave), 1e-10)
        if mesh.unknown_count > LARGEST or not np.isfinite(real):
            return None
        A, B = whole_matrices(rod, mesh)
        w = inverse_spectrum(A, B)
        inside = (np.abs(w.imag) <= imag) & (w.real <= real)
        if (inside & (np.abs(w.real) < CLEAR * real)).any():
            return None
        count = int((inside & (w.real > 0)).sum())
    return count


def solve_stretch(stretch: NeighbouringRods, request: SpectrumRequest) -> Spectrum:
    """Spectra of all rods of a stretch: followed, or else alone, as in a sweep."""
    followed = follow_spectra(stretch, request)
    for i in np.flatnonzero(~followed.is_solved).tolist():
        alone = solve_spectrum(stretch.rod_at(i), request)
        for name in (
            "eigenvalues",
            "error_estimate",
            "unstable_count",
            "certified",
            "elements",
            "order",
            "status",
            "message",
        ):
            getattr(followed.spectra, name)[i] = getattr(alone, name)
    return followed.spectra


@dataclass
class Comparison:
    """How many points were compared, and what differs, in words."""

    points: int = 0
    followed: int = 0
    counted: int = 0
    unstable: int = 0
    """The most unstable modes met."""
    differences: list[str] = field(default_factory=list)

    def add(self, whole: NeighbouringRods, modes: int = 4, dense: bool = True, every: int = 1) -> None:
        """Compares each `every`-th point of a line with what the solver of single points and LAPACK find."""
        request = SpectrumRequest(modes, 1e-10, certify=True)
        for part in parts(whole):
            found = solve_stretch(part, request)
            for i in range(0, len(part), every):
                self._add_point(part.rod_at(i), found, i, request)
                count = dense_count(part.rod_at(i)) if dense and found.certified[i] else None
                if count is not None:
                    self.counted += 1
                    if count != found.unstable_count[i]:
                        self.differences.append(f"{part.rod_at(i)}: LAPACK counts {count}")

    def _add_point(self, rod: Rod, found, i: int, request: SpectrumRequest) -> None:
        self.points += 1
        alone = solve_spectrum(rod, request)
        if found.elements[i] or found.status[i] != SpectrumStatus.ok:  # this is what that solver said
            same = alone.status == found.status[i]
            same = same and np.array_equal(alone.eigenvalues, found.eigenvalues[i], equal_nan=True)
            self.differences += [] if same else [f"{rod}: {found.status[i]} instead of {alone.status}"]
            return
        self.followed += 1
        self.unstable = max(self.unstable, int(found.unstable_count[i]))
        if not alone.certified:  # better than before
            return
        if alone.unstable_count not in (-1, found.unstable_count[i]):
            self.differences.append(f"{rod}: {found.unstable_count[i]}, not {alone.unstable_count} unstable")
        away = np.abs(alone.eigenvalues - found.eigenvalues[i])
        allowed = np.maximum(
            1e-13 * np.abs(alone.eigenvalues), alone.error_estimate + found.error_estimate[i]
        )
        if not (away <= allowed).all():
            self.differences.append(f"{rod}: off by {away / allowed} of what is allowed")
