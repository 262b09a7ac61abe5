"""The leading eigenvalue of an arm of a chain, from propagators that are interpolated over a range of arms.

A chain solves rods one after another, in steps of one parameter. As soon as the step is known, a range of the
parameter is chosen that contains many further arms of the chain. The propagators of all arms of the range
follow from those of a few arms, and so do the hulls of their spectra; an eigenvalue and the proof that it
leads then take a fraction of the time that a single arm takes. Results depend on the range and on the
eigenvalues of the neighbouring arm only, so that an interrupted chain resumes with the same results.
"""

from dataclasses import dataclass
from functools import lru_cache
from math import floor, inf, nan
from typing import ClassVar, NamedTuple

import numpy as np

from ....arrays import Array, Complex, list_of
from ....determinant.arm.arm_family import ArmFamily
from ....determinant.arm.hull.hull import hulls_along
from ....determinant.arm.hull.region import PathHulls
from ....determinant.parameter_path import ParameterPath
from ....model.compiled.kernel_constants import KernelConstants
from ....model.material.rod_material import RodMaterial
from ....model.parameters import PARAMETERS
from ....model.rod import Rod
from ..candidates import line_for_proof
from .arm_following import ARM_FOLLOWING_SETTINGS, follow_eigenvalues_of_arms
from .arm_interval import arm_family_for_proofs
from .carried_count import leading_eigenvalues_of_track
from .eigenvalue_prediction import new_track


@dataclass(frozen=True, slots=True, kw_only=True)
class ArmRangeSettings(KernelConstants):
    """Settings for the parameter ranges over which the propagators of a chain of arms are interpolated."""

    max_relative_length: float = 0.2
    """Largest length of a range, in the coordinate of the varied parameter, divided by the coordinate at the
    start of the range. 0.2 is the change of the parameter after which a chain of cycles measures the errors
    of its mesh again."""
    min_chain_steps_per_range: int = 8
    """A range is chosen only if it contains at least this many steps of the chain: the propagators of a range
    take the time of about five single arms."""
    hull_count: int = 5
    """Number of arms of a range, both ends included, for which the hull of the spectrum (`EigenvalueHull`) is
    computed."""
    max_successive_failures: int = 2
    """Number of successive arms without a proof after which a range is given up. A single failure, for
    example where a pair of eigenvalues becomes real, does not last."""
    max_cached_ranges: int = 2
    """Maximum number of ranges whose propagators are cached; a chain of rods uses one range at a time."""
    field_ranges: ClassVar = {
        "hull_count": (2, inf),
        "min_chain_steps_per_range": (1, inf),
        "max_successive_failures": (1, inf),
    }
    """Exclusive bounds (lower, upper) of a field, by name of the field."""


ARM_RANGE_SETTINGS = ArmRangeSettings()


class ArmRange(NamedTuple):
    """Range of a parameter that contains the next arms of a chain of rods, which are solved one after
    another. low, high: smallest and largest coordinate of the parameter. max_abs_w: largest |w| of the
    eigenvalues that are followed. proof_line: real part <= 0 of a line left of the leading eigenvalue; the
    proof shows that no eigenvalue right of this line is missing. max_abs_w and proof_line belong to the arm
    at which the range begins. successive_failure_count: number of successive arms, up to the last arm solved,
    for which the range gave no proof."""

    low: float
    high: float
    max_abs_w: float
    proof_line: float
    successive_failure_count: float = 0.0

    @property
    def is_usable(self) -> bool:
        """Whether the range is tried at further arms."""
        return self.successive_failure_count < ARM_RANGE_SETTINGS.max_successive_failures


NO_RANGE = ArmRange(nan, nan, nan, nan)
"""In place of a range, for an arm whose leading eigenvalue can be proved to lead only by a winding number:
interpolated propagators would prove nothing at the next arm either, so no range is tried there."""


def next_range(
    rod: Rod, previous_rod: Rod, name: str, current: ArmRange | None, eigenvalues: Complex
) -> ArmRange | None:
    """The range that contains the next arm of a chain: `current` if possible; None for uniform rods, for a
    step of length 0 or a step so long that fewer than `min_chain_steps_per_range` steps fit into a range, and
    if `current` is `NO_RANGE`.

    rod, previous_rod: the last two rods of the chain. name: the varied parameter. current: range of `rod`,
    `NO_RANGE` or None. eigenvalues: followed eigenvalues of `rod`, (n,), the leading eigenvalue first."""
    start = rod.coordinate(name)
    step = start - previous_rod.coordinate(name)
    if current is not None and (current is NO_RANGE or current.low <= start + step <= current.high):
        return None if current is NO_RANGE else current
    max_length = ARM_RANGE_SETTINGS.max_relative_length * abs(start)
    is_long = abs(step) * ARM_RANGE_SETTINGS.min_chain_steps_per_range > max_length
    if rod.is_uniform or step == 0 or is_long or not np.isfinite(eigenvalues).all():
        return None
    low, high = sorted((start, start + floor(max_length / abs(step)) * step))
    line = line_for_proof(complex(eigenvalues[0]), 0.0)
    return ArmRange(low, high, float(np.abs(eigenvalues).max()), line)


def leader_in_range(
    rod: Rod, name: str, arm_range: ArmRange, guesses: Complex
) -> tuple[Complex, Array] | None:
    """Returns (w, errors), (m,) each: the eigenvalues of `rod` with Im w >= 0 near `guesses`, (n,), by
    descending real part, and their errors. None if a guess leads to no eigenvalue, if w[0] is not proved to
    be the leading eigenvalue, or if the rod lies outside `arm_range`. name: the varied parameter of the
    chain. arm_range: range with interpolated propagators. guesses: eigenvalues with Im w >= 0 of the previous
    rod, the leading eigenvalue first."""
    p = rod.coordinate(name)
    if not (arm_range.low <= p <= arm_range.high and arm_range.is_usable and np.isfinite(guesses).all()):
        return None
    # A rod would be a slower key, because every new rod tests its values.
    values = {**rod.values, name: PARAMETERS[name].value(arm_range.low)}
    # Failures change no propagators, so they must not be part of the key.
    family_data = arm_family_and_hulls_of_range(
        tuple(values.items()), rod.material, name, arm_range._replace(successive_failure_count=0.0)
    )
    if family_data is None:
        return None
    upper_w = list_of(guesses)
    first_w = upper_w + [w.conjugate() for w in upper_w if w.imag]
    first_w.sort(key=lambda w: (-w.real, -w.imag))
    track = new_track(np.array(first_w, complex), 1)
    proved_counts = np.zeros(1, np.int64)
    mode_count = 2 if guesses[0].imag else 1
    reached = follow_eigenvalues_of_arms(track, *family_data, np.array([p]), mode_count, proved_counts)
    if not reached or proved_counts[0] < mode_count:
        return None
    w, error = leading_eigenvalues_of_track(track, len(first_w))
    is_upper = w[0].imag >= 0
    return w[0][is_upper], error[0][is_upper]


@lru_cache(maxsize=ARM_RANGE_SETTINGS.max_cached_ranges)
def arm_family_and_hulls_of_range(
    values: tuple[tuple[str, float], ...], material: RodMaterial, name: str, arm_range: ArmRange
) -> tuple[ArmFamily, PathHulls] | None:
    """Returns (family, hulls), cached: the interpolated propagators of the arms of a range, and regions that
    contain the spectra of these arms. None if the arms are not smooth in the parameter, or if no elements
    resolve an arm. values, material: parameter values by name, and material, of the arm at `arm_range.low`.
    name: the varied parameter."""
    W = ARM_FOLLOWING_SETTINGS.family_W_over_max_abs_eigenvalue * arm_range.max_abs_w
    try:
        path = ParameterPath(Rod(**dict(values), material=material), name)
        hulls = hulls_along(path, arm_range.low, arm_range.high, ARM_RANGE_SETTINGS.hull_count)
        family = arm_family_for_proofs(path, hulls, W, arm_range.proof_line)
    except (ValueError, FloatingPointError):
        return None
    return None if family is None else (family, hulls)
