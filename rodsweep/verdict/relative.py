"""Reference flutter of a relative load: the smallest in any plane of the arm, with the likeliest drag.

This module must not need PETSc: PETSc starts on all ranks together, but rank 0 alone makes the points.
"""

from dataclasses import replace
from functools import cache
from math import inf
from typing import TypeVar

from ..determinant.certificate.covering import cover, first_boxes
from ..determinant.newton import Zero
from ..determinant.parameter_path import Path, coefficients_at, determinant_along
from ..errors import InputError
from ..model.arm.arm import SlenderArm
from ..model.rod import Rod
from ..solve.changes.unstable_modes import SHORT_OF_CRUSHED

A = TypeVar("A", bound=SlenderArm)
FARTHEST = 1000.0
"""Largest force of the search, in k3/L^2, unless crushed before: 25 times flutter of a filament."""
NEAR = 200.0
"""Largest force of a first search, in k3/L^2, which takes half of the time; few arms flutter beyond."""
DIGITS = 10
"""Digits of the reference threshold: more than the data of an arm have, and few enough for equal results on
all machines. Hence a run resumed on a different machine has the same points."""


def turned(arm: A) -> A:
    """The same arm, turned by 90 degrees: width and height of the rectangle exchanged."""
    return replace(arm, width=arm.height, height=arm.width)


def first_flutter(arm: SlenderArm) -> float:
    """Smallest flutter force over the planes of an arm, in its k3/L^2; inf without flutter."""
    own = _in_its_plane(arm)
    if arm.isotropic:
        return own
    other = turned(arm)
    stiffer = other.cross_section.second_moment / arm.cross_section.second_moment
    return min(own, _in_its_plane(other) * stiffer)


def _in_its_plane(arm: SlenderArm) -> float:
    """Flutter force in the plane of the arm's height, in k3/L^2; inf without flutter."""
    return first_hopf_force(arm.k1, arm.k2, arm.gamma3_with(arm.drags[0]))


@cache
def first_hopf_force(k1: float, k2: float, gamma3: float) -> float:
    """Smallest F at which a pair of modes becomes unstable, to DIGITS digits; inf if none up to FARTHEST.

    InputError if the covering cannot exclude a smaller F.
    """
    path = Path(Rod(k1=k1, k2=k2, gamma3=gamma3, F=0.0), "F")
    for end in (NEAR, FARTHEST):
        boxes = first_boxes(path, 0.0, min(end, k1 * (1 - SHORT_OF_CRUSHED)))
        if boxes is None:
            raise InputError("the flutter that a load is relative to has no bound, so it is not found")
        zeros, left, _ = cover(boxes, path.origin, path.direction)
        first = min((zero.p for zero in zeros if _grows(path, zero)), default=inf)
        if any(min(box.p_from, box.p_to) < first for box in left):
            raise InputError("the flutter that a load is relative to is not decided")
        if first < inf:
            return float(f"{first:.{DIGITS}g}")
    return inf


def _grows(path: Path, zero: Zero) -> bool:
    """Whether the growth rate of the pair on the imaginary axis increases with F."""
    there = determinant_along(
        complex(0.0, zero.eta_or_x), coefficients_at(zero.p, path.origin, path.direction), path.direction
    )
    return bool((-there.D_p / there.D_w).real > 0)
