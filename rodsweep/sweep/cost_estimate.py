"""Estimated cost of a sweep before its start: time, and for spectra memory and unknowns, from sampled points.

Times are for a single core like the core described in docs/performance.md.
"""

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ..discretization.elements.resolution import RESOLUTION_SETTINGS
from ..discretization.straight.arm_resolution import arm_mesh
from ..discretization.straight.uniform_resolution import first_resolution
from ..model.dispersion import expected_unstable_count, sampled_arm
from ..model.rod import Rod
from .points.groups import PointGroups
from .points.points import Points

MAX_SAMPLED_POINTS = 200
"""Largest number of points whose meshes are computed for an estimate."""
SPECTRUM_FIXED_MS = 0.03
"""Part of the measured solve time of a spectrum that is independent of the number of unknowns, in ms."""
SPECTRUM_MS_PER_UNKNOWN = 2.2e-3
"""Measured time of the orthogonalisation in the solve of a spectrum, in ms per unknown."""
SPECTRUM_MS_PER_CUBED_UNKNOWN = 1.5e-7
"""Measured time of the dense factorisation in the solve of a spectrum, in ms per cubed number of unknowns."""
MIN_SPARSE_UNKNOWNS = 300
"""Number of unknowns above which the solver factorises sparse matrices instead of dense matrices."""
SPARSE_MS_PER_UNKNOWN = 8e-3
"""Time of the solve of a spectrum with a sparse factorisation, in ms per unknown."""
CERTIFICATE_MS = 0.15
"""Time to certify one spectrum by winding numbers, in ms."""
CERTIFIED_ARM_SPECTRUM_MS = 4.0
"""Time to evaluate D and certify one spectrum of an arm that is not uniform, in ms: median of 40 arms."""
ARM_MS_PER_SQUARED_UNSTABLE_MODE = 0.08
"""Time to find all unstable modes of an arm that is not uniform, divided by the squared number of these
modes, in ms: within a factor of two for 25 arms with up to 62 unstable modes; 82 and 110 modes took 1.3 and
2.8 times as long."""
ARM_CODE_LOADING_SECONDS = 0.35
"""Time in which a rank loads the compiled code for arms that are not uniform, at its first point, in s: in
six tasks the first solve of a rank took 0.24 to 0.43 s longer than the second."""
MAX_EXTRA_MODES_OF_FOLLOWED_ARM = 9
"""Eigenvalues of an arm are followed only if its number of unstable modes exceeds the number of requested
modes by at most this number."""
GROUP_START_TO_SINGLE_POINT_TIME = 2.0
"""Time of the first point of a group, divided by the time of a point that is solved alone."""
FOLLOWED_POINT_MS = 0.006
"""Time per point of a group, in which eigenvalues are continued from a neighbouring point, in ms."""
FOLLOWED_ARM_POINT_MS = 0.15
"""Time per point, including the first point, of a group of arms that are not uniform, in ms: median of 30."""
ROD_MS_PER_SQUARED_UNSTABLE_MODE = 0.02
"""Time of a spectrum of a uniform rod with N unstable modes, divided by N^2 (1 + (N/
MIN_UNSTABLE_MODES_OF_QUARTIC_TIME)^2), in ms: 0.014 to 0.025 for eight soft rods with 64 to 1000 unstable
modes, up to 0.1 for rods with ten."""
MIN_UNSTABLE_MODES_OF_QUARTIC_TIME = 500.0
"""Number of unstable modes at which the time of a spectrum begins to grow with their fourth power."""
PULLED_MS_PER_LAYER_WAVE_NUMBER = 0.4
"""Time of a spectrum of a pulled rod, divided by the wave number of the layers at its ends, in ms L: 0.2 to
0.8 for nine rods under pulls of 1e3 to 1e6, not all resolved; 0.02 for a rod without compliances at 1e3."""
MAX_RESOLVED_LAYER_WAVE_NUMBER = 25.0
"""Wave number, in 1/L, below which the first mesh of a pulled rod resolves the layers at its ends."""
BEYOND_SHEAR_STIFFNESS_TEXT = "rods under a pull beyond the shear stiffness"
"""Kind of rods whose spectra are not estimated reliably: of 13 rods under pulls F < -k2 nu nine took 4 to 60
times as long as estimated, one 800 times; the time grows as gamma3 decreases."""
MAX_RESOLVED_SQUARED_WAVE_NUMBER = 1e8
"""Squared wave number, in 1/L^2, beyond which a spectrum takes no longer: no allowed mesh resolves it."""
TWO_MESHES_TIME_OVER_ROOTS_TIME = 8.0
"""Time of a spectrum by Krylov-Schur on two meshes, divided by the time by roots of D: mean over 800 rods."""
EXTRA_TWO_MESHES_TIME_OVER_ROOTS_TIME = 0.05
"""Additional time of soft or pulled rods by Krylov-Schur on two meshes, which finds only the requested modes,
divided by the additional time by roots of D; measured for three rods."""
FINER_MESH_UNKNOWNS_RATIO = 4 / 3
"""Ratio of the numbers of unknowns of the second and the first mesh, in a spectrum by Krylov-Schur."""
MODES_MS_PER_SQUARED_MODE_COUNT = 0.4
"""Time of the eigenvectors at one point divided by the square of the number of modes, in ms: mean over 24
rods with 4, 8 and 12 modes each. The time is quadratic because the mesh grows with the number of modes."""
PULLED_MODES_MS_PER_SQUARED_LAYER_WAVE_NUMBER = 0.012
"""Further time of the eigenvectors of a pulled rod, whose mesh resolves the layers at its ends, divided by
the squared wave number of the layers, in ms L^2: 0.009 to 0.022 for nine rods with wave numbers from 27 to
714, 0.004 and 0.008 for two cones."""
MAX_RESOLVED_WAVE_NUMBER = 1000.0
"""Wave number, in 1/L, of a pulled rod's boundary layers, above which no mesh resolves even the spectrum."""
TRANSIENT_GROWTH_MS = 55.0
"""Time of the transient growth of one rod, in ms: mean over 24 rods, 52 to 75 ms with 2 to 12 modes."""
MEMORY_PER_UNKNOWN = 40_000
"""Memory of a rank per unknown of its largest mesh, in bytes."""
BASE_MEMORY_BYTES = 200_000_000
"""Memory of a rank without any mesh, in bytes."""


@dataclass(frozen=True, slots=True)
class CostEstimate:
    """Estimated cost of a sweep on a single core like the core described in docs/performance.md."""

    seconds: float
    """Time of the whole sweep on one rank, in s."""
    memory_bytes: int = BASE_MEMORY_BYTES
    """Memory of a rank, in bytes."""
    unknown_count_range: tuple[int, int] | None = None
    """Smallest and largest number of unknowns of the sampled points' meshes; None if not estimated."""
    too_large_mesh_count: int = 0
    """Number of sampled points whose mesh would need more than RESOLUTION_SETTINGS.max_unknowns unknowns."""
    underestimated_rods: str = ""
    """Kind of rods whose time and memory may be many times as large as estimated; empty if the estimate is
    expected to hold within a factor of about two."""
    uncounted_work: str = ""
    """Work that the estimate does not contain, because only the sweep shows how much there is; empty if it
    contains all work."""


def with_arm_code_loading_time(cost: CostEstimate) -> CostEstimate:
    """The cost with the time in which a rank loads the compiled code of arms that are not uniform."""
    return replace(cost, seconds=cost.seconds + ARM_CODE_LOADING_SECONDS)


def modes_cost(
    spectra_estimate: CostEstimate, points: Points, mode_count: int, includes_growth: bool
) -> CostEstimate:
    """Cost of `mode_count` eigenvectors at each of the `points`, from the cost `spectra_estimate` of the
    eigenvalues. includes_growth: whether the transient growth is computed too."""
    rods = [points.rod(int(index)) for index in sampled_points_with_rod(points)]
    waves = np.array([_layer_wave_number(_squared_wave_number(rod)) for rod in rods] or [0.0])
    resolved = waves[waves <= MAX_RESOLVED_WAVE_NUMBER]
    layers_ms = PULLED_MODES_MS_PER_SQUARED_LAYER_WAVE_NUMBER * float((resolved**2).sum()) / waves.size
    point_ms = (
        MODES_MS_PER_SQUARED_MODE_COUNT * mode_count**2
        + layers_ms
        + (TRANSIENT_GROWTH_MS if includes_growth else 0)
    )
    extra_seconds = points.count * 1e-3 * point_ms
    return replace(
        spectra_estimate, seconds=spectra_estimate.seconds + extra_seconds, unknown_count_range=None
    )


def followed_spectra_cost(
    alone: CostEstimate, groups: PointGroups, points: Points, mode_count: int
) -> CostEstimate:
    """Estimated cost of the spectra of `points` followed along groups. alone: cost of solving every
    point alone. mode_count: number of eigenvalues."""
    ratio = GROUP_START_TO_SINGLE_POINT_TIME * groups.count / points.count
    rods = [points.rod(int(index)) for index in sampled_points_with_rod(points)]
    are_uniform = all(rod.is_uniform_and_linear for rod in rods)
    point_ms = FOLLOWED_POINT_MS if are_uniform else FOLLOWED_ARM_POINT_MS
    unstable = _unstable_counts_of_arms(rods)
    # Such arms are not followed, so each of their points is solved alone.
    are_alone = unstable > mode_count + MAX_EXTRA_MODES_OF_FOLLOWED_ARM
    extra_ms = ARM_MS_PER_SQUARED_UNSTABLE_MODE * unstable**2 * are_alone
    point_ms += float(extra_ms.mean()) if rods else 0.0
    # The first points of short groups would make following seem slower than solving every point alone.
    return replace(alone, seconds=alone.seconds * min(1.0, ratio) + points.count * 1e-3 * point_ms)


def two_meshes_cost(points: Points, mode_count: int, accuracy: float) -> CostEstimate:
    """Estimated cost of the spectra of `points` by Krylov-Schur on two meshes. mode_count: number of
    eigenvalues. accuracy: relative accuracy."""
    one_mesh = spectra_cost(points, mode_count, accuracy, certify=False)
    rods = [points.rod(int(index)) for index in sampled_points_with_rod(points)]
    extra = points.count * 1e-3 * float(np.mean([_extra_soft_or_pulled_rod_ms(rod) for rod in rods] or [0.0]))
    # The part for soft and pulled rods is taken out of the factor, as it has a factor of its own.
    seconds = TWO_MESHES_TIME_OVER_ROOTS_TIME * (one_mesh.seconds - extra)
    seconds += EXTRA_TWO_MESHES_TIME_OVER_ROOTS_TIME * extra
    low, high = one_mesh.unknown_count_range or (0, 0)
    unknowns = one_mesh.unknown_count_range and (low, math.ceil(FINER_MESH_UNKNOWNS_RATIO * high))
    return replace(one_mesh, seconds=seconds, unknown_count_range=unknowns)


def spectra_cost(points: Points, mode_count: int, accuracy: float, certify: bool) -> CostEstimate:
    """Estimated cost of the spectra of `points`, extrapolated from evenly spaced points of the sweep; 0 if
    the rod model applies to none of these points. mode_count: number of eigenvalues. accuracy: relative
    accuracy. certify: whether spectra are certified."""
    rods = [points.rod(int(index)) for index in sampled_points_with_rod(points)]
    counts = [_first_mesh_unknown_count(rod, mode_count, accuracy) for rod in rods]
    if not counts:  # no rod covers any point of the sample
        return CostEstimate(0.0)
    arm_fraction = sum(not rod.is_uniform_and_linear for rod in rods) / len(rods)
    # A rod whose mesh would be larger is refused at once, so it costs no more than the largest mesh.
    n = np.minimum(np.array(counts, dtype=float), RESOLUTION_SETTINGS.max_unknowns)
    dense_ms = SPECTRUM_FIXED_MS + SPECTRUM_MS_PER_UNKNOWN * n + SPECTRUM_MS_PER_CUBED_UNKNOWN * n**3
    point_ms = np.where(n <= MIN_SPARSE_UNKNOWNS, dense_ms, SPARSE_MS_PER_UNKNOWN * n)
    point_ms += CERTIFICATE_MS if certify else 0
    unstable = _unstable_counts_of_arms(rods)
    point_ms += arm_fraction * CERTIFIED_ARM_SPECTRUM_MS + ARM_MS_PER_SQUARED_UNSTABLE_MODE * unstable**2
    point_ms += np.array([_extra_soft_or_pulled_rod_ms(rod) for rod in rods])
    memory = BASE_MEMORY_BYTES + int(n.max()) * MEMORY_PER_UNKNOWN
    # Counted before the limit is applied, so that the user learns of rods that will not be solved.
    too_large = int((np.array(counts) > RESOLUTION_SETTINGS.max_unknowns).sum())
    doubt = BEYOND_SHEAR_STIFFNESS_TEXT if any(map(_is_beyond_shear_stiffness, rods)) else ""
    seconds = float(point_ms.mean()) * 1e-3 * points.count
    return CostEstimate(seconds, memory, (min(counts), max(counts)), too_large, doubt)


def _unstable_counts_of_arms(rods: list[Rod]) -> NDArray[np.float64]:
    """Expected number of unstable modes, (rods,), at most `max_unknowns`; 0 for uniform linear rods."""
    counts = [0.0 if rod.is_uniform_and_linear else expected_unstable_count(rod) for rod in rods]
    return np.minimum(counts, RESOLUTION_SETTINGS.max_unknowns)


def _extra_soft_or_pulled_rod_ms(rod: Rod) -> float:
    """Additional time of the spectrum of a uniform rod with many unstable modes, or of any rod with thin
    layers under a strong pull, in ms; 0 for all other rods."""
    squared_wave_number = _squared_wave_number(rod)
    if squared_wave_number > 0:
        count = math.sqrt(min(squared_wave_number, MAX_RESOLVED_SQUARED_WAVE_NUMBER)) / math.pi
        return (
            ROD_MS_PER_SQUARED_UNSTABLE_MODE
            * count**2
            * (1 + (count / MIN_UNSTABLE_MODES_OF_QUARTIC_TIME) ** 2)
        )
    return PULLED_MS_PER_LAYER_WAVE_NUMBER * _layer_wave_number(squared_wave_number)


def _squared_wave_number(rod: Rod) -> float:
    """Squared wave number, in 1/L^2: of the shortest growing wave of a uniform rod under a push (positive);
    of the boundary layers of a rod under a pull, with a minus sign; 0 for other rods."""
    if rod.is_uniform_and_linear:
        return rod.F * rod.g
    # The unstable modes of arms are counted in `spectra_cost`.
    local = sampled_arm(rod).local_coefficients
    return min(rod.F, 0.0) * float(np.max(local.c3 * np.maximum(local.g, 0.0)))


def _layer_wave_number(squared_wave_number: float) -> float:
    """Wave number of the layers at the ends of a pulled rod, in 1/L; 0 where its first mesh resolves them.
    squared_wave_number: as from `_squared_wave_number`."""
    wave_number = math.sqrt(min(max(-squared_wave_number, 0.0), MAX_RESOLVED_SQUARED_WAVE_NUMBER))
    return wave_number if wave_number > MAX_RESOLVED_LAYER_WAVE_NUMBER else 0.0


def _is_beyond_shear_stiffness(rod: Rod) -> bool:
    """Whether the pull on a rod exceeds its shear stiffness somewhere: g = nu + F c2 < 0."""
    g = rod.g if rod.is_uniform_and_linear else float(np.min(sampled_arm(rod).local_coefficients.g))
    return rod.F < 0 and g < 0


def _first_mesh_unknown_count(rod: Rod, mode_count: int, accuracy: float) -> int:
    """Number of unknowns of the first mesh on which `rod` is solved for `mode_count` modes to the relative
    accuracy `accuracy`."""
    if not rod.is_uniform_and_linear:
        return arm_mesh(rod, mode_count, accuracy).unknown_count
    return first_resolution(rod, mode_count, accuracy).unknown_count


def sampled_points_with_rod(points: Points, max_count: int = MAX_SAMPLED_POINTS) -> NDArray[np.int64]:
    """Flat indices, (n,), of at most `max_count` evenly spaced points of a sweep, without points to which the
    rod model does not apply."""
    # Rounding gives the same index twice if there are few points.
    indices = np.unique(np.linspace(0, points.count - 1, min(max_count, points.count)).astype(np.int64))
    return indices[[points.is_in_model(int(index)) for index in indices]]
