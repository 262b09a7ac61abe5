"""Reference of a load relative to flutter: the smallest flutter load over all planes, with likeliest drag.

The module must not need PETSc: rank 0 alone makes the points, but PETSc has to start on all ranks together.
"""

from dataclasses import replace
from functools import cache
from math import inf
from typing import TypeVar

import numpy as np

from ..determinant.certificate.covering import cover, first_boxes
from ..determinant.newton import Zero
from ..determinant.parameter_path import Path, coefficients_at, determinant_along
from ..errors import InputError
from ..model.arm.arm import SlenderArm
from ..model.rod import Rod
from ..solve.changes.unstable_modes import CRUSHING_MARGIN

A = TypeVar("A", bound=SlenderArm)
PlaneRod = tuple[float, float, float]
"""(k1, k2, gamma3) of an arm moving in one plane."""
FARTHEST = 1000.0
"""Largest force of the search, in k3/L^2, 25 times flutter of a filament; less for an arm crushed before."""
NEAR = 200.0
"""Largest force of a first search, in k3/L^2, which takes half of the time. Few arms flutter at larger
forces."""
REFERENCE_DIGITS = 10
"""Digits of the reference threshold: more than the data of an arm, and few enough for equal results on all
machines. A run resumed on another machine therefore has the same points."""


class FlutterUnknown(InputError):
    """The search for the reference flutter of a relative load failed; the message states the reason."""


def turned(arm: A) -> A:
    """The same arm, turned by 90 degrees: width and height of the rectangle exchanged."""
    return replace(arm, width=arm.height, height=arm.width)


def plane_rods(arm: SlenderArm) -> list[tuple[PlaneRod, float]]:
    """(rod with the likeliest drag, unit of force) for each plane of an arm.

    The unit of force is k3/L^2 in the plane, over k3/L^2 of the arm.
    """
    planes = [(_in_its_plane(arm), 1.0)]
    if not arm.isotropic:
        other = turned(arm)
        scale = other.cross_section.second_moment / arm.cross_section.second_moment
        planes.append((_in_its_plane(other), scale))
    return planes


def _in_its_plane(arm: SlenderArm) -> PlaneRod:
    """The rod in the plane of the arm's height."""
    return arm.k1, arm.k2, arm.gamma3_with(arm.drags[0])


def first_flutter(arm: SlenderArm) -> float:
    """Smallest flutter force over the planes of an arm, in k3/L^2 of the arm; inf without flutter.

    Raises FlutterUnknown if the search fails.
    """
    return min(first_hopf_force(*rod) * scale for rod, scale in plane_rods(arm))


@cache
def first_hopf_force(k1: float, k2: float, gamma3: float) -> float:
    """Smallest F at which a pair of modes becomes unstable, to REFERENCE_DIGITS digits.

    inf without flutter up to FARTHEST. Raises FlutterUnknown if the covering cannot exclude a smaller F, or
    for overflow.
    """
    path = Path(Rod(k1=k1, k2=k2, gamma3=gamma3, F=0.0), "F")
    try:
        for end in (NEAR, FARTHEST):
            first = _first_up_to(path, min(end, k1 * (1 - CRUSHING_MARGIN)))
            if first < inf:
                return float(f"{first:.{REFERENCE_DIGITS}g}")
    except (ArithmeticError, MemoryError, np.linalg.LinAlgError) as error:
        why = str(error) or type(error).__name__
        sentence = f"the search for the flutter threshold of a relative load fails: {why}"
        raise FlutterUnknown(sentence) from error
    return inf


def _first_up_to(path: Path, end: float) -> float:
    """Smallest F, at most `end`, at which a pair of modes becomes unstable; inf for none."""
    boxes = first_boxes(path, 0.0, end)
    if boxes is None:
        raise FlutterUnknown("the flutter threshold of a relative load is not found: no bound applies")
    zeros, left, _ = cover(boxes, path.origin, path.direction)
    first = min((zero.p for zero in zeros if _grows(path, zero)), default=inf)
    if any(min(box.p_from, box.p_to) < first for box in left):
        raise FlutterUnknown("the flutter threshold of a relative load is not decided")
    return first


def _grows(path: Path, zero: Zero) -> bool:
    """Whether the growth rate of the pair on the imaginary axis increases with F."""
    there = determinant_along(
        complex(0.0, zero.eta_or_x), coefficients_at(zero.p, path.origin, path.direction), path.direction
    )
    return bool((-there.D_p / there.D_w).real > 0)
