"""Reference of a load relative to flutter: the smallest flutter load over all planes, with likeliest drag.

Uniform arms of linear material must not need PETSc here. The search for another arm starts it, so that all
ranks must have started it before they share such searches.
"""

from dataclasses import replace
from functools import cache
from math import inf
from typing import TypeVar

import numpy as np

from ..determinant.certificate.covering import cover
from ..determinant.certificate.first_boxes import first_boxes
from ..determinant.parameter_path import Path, coefficients_at, determinant_along
from ..determinant.roots.newton import LocatedZero
from ..errors import InputError
from ..model.arm.arm import SlenderArm
from ..model.arm.drag import Drag
from ..model.material.build import Build
from ..model.rod import Rod
from ..solve.changes.unstable_modes import ChangeKind, end_below_crushing

A = TypeVar("A", bound=SlenderArm)
SEARCH_END = 1000.0
"""Largest force of the search, in k3/L^2, 25 times flutter of a filament; less for an arm crushed before."""
FIRST_SEARCH_END = 200.0
"""Largest force of a first search, in k3/L^2, which takes half of the time. Few arms flutter at larger
forces."""
ENDS_OF_VARIED = (3.0, 10.0, 30.0, 100.0, 300.0, SEARCH_END)
"""Largest forces of the search for an arm that is not uniform or not of linear material, in k3/L^2 at its
base, tried in turn: a search far beyond the first flutter, where many modes are unstable, takes up to half a
minute for each drag."""
REFERENCE_DIGITS = 10
"""Digits of the reference threshold: more than the data of an arm, and few enough for equal results on all
machines. A run resumed on another machine therefore has the same points."""


class FlutterUnknown(InputError):
    """The search for the reference flutter of a relative load failed; the message states the reason."""


def turned(arm: A) -> A:
    """The arm turned by 90 degrees: width and height of the rectangle exchanged."""
    return replace(arm, width=arm.height, height=arm.width)


def plane_rods(
    arm: SlenderArm, build: Build | None = None, taper: float | None = None
) -> list[tuple[Rod, float]]:
    """(rod, k3/L^2 of the rod in units of the arm's) for each plane of motion, with the likeliest drag and
    without load.

    build, taper: law and profile, and tip radius over base radius, in place of the arm's.
    """
    planes = [(_in_its_plane(arm, build, taper), 1.0)]
    if not arm.isotropic:
        other = turned(arm)
        scale = other.cross_section.second_moment / arm.cross_section.second_moment
        planes.append((_in_its_plane(other, build, taper), scale))
    return planes


def _in_its_plane(arm: SlenderArm, build: Build | None, taper: float | None) -> Rod:
    """The rod in the plane of the arm's height."""
    rod = rod_with(arm, arm.drags[0], build)
    return rod if taper is None else replace(rod, taper=taper)


def rod_with(arm: SlenderArm, drag: Drag, build: Build | None = None) -> Rod:
    """The arm as a rod without load, with the given drag, in the plane of its height. build: as in
    `plane_rods`."""
    own = {"k1": arm.k1, "k2": arm.k2, "gamma3": arm.gamma3_with(drag), "taper": arm.taper}
    return Rod(F=0.0, **own, build=build or arm.build_with(drag))


def first_flutter(arm: SlenderArm) -> float:
    """Smallest flutter force over the planes of an arm, in k3/L^2 of the arm; inf without flutter.

    Raises FlutterUnknown if the search fails.
    """
    return min(first_hopf_force(rod) * scale for rod, scale in plane_rods(arm))


@cache
def first_hopf_force(rod: Rod) -> float:
    """Smallest F at which a pair of modes becomes unstable, to REFERENCE_DIGITS digits.

    inf without flutter up to FARTHEST. Raises FlutterUnknown if the search cannot exclude a smaller F, or
    for overflow.
    """
    path = Path(rod, "F")
    first_up_to = _first_up_to if rod.standard else _first_of_varied
    try:
        for end in (FIRST_SEARCH_END, SEARCH_END) if rod.standard else ENDS_OF_VARIED:
            first = first_up_to(path, end_below_crushing(rod, end))
            if first < inf:
                return float(f"{first:.{REFERENCE_DIGITS}g}")
    except (ArithmeticError, MemoryError, np.linalg.LinAlgError) as error:
        why = str(error) or type(error).__name__
        raise FlutterUnknown(
            f"the search for the flutter threshold of a relative load fails: {why}"
        ) from error
    return inf


def _first_up_to(path: Path, end: float) -> float:
    """Smallest F, at most `end`, at which a pair of modes becomes unstable; inf for none."""
    boxes = first_boxes(path, 0.0, end)
    if boxes is None:
        raise FlutterUnknown(
            "the flutter threshold of a relative load is not found: no a-priori bound on the eigenvalues "
            "applies to this rod"
        )
    zeros, left, _ = cover(boxes, path.origin, path.direction)
    first = min((zero.p for zero in zeros if _grows(path, zero)), default=inf)
    if any(min(box.p_from, box.p_to) < first for box in left):
        raise FlutterUnknown(
            "the flutter threshold of a relative load is not decided: a narrow window of flutter may lie "
            "below the first Hopf point found"
        )
    return first


def _first_of_varied(path: Path, end: float) -> float:
    """Smallest F up to `end` at which a pair becomes unstable, inf for none, by a search for crossings: for
    arms that are not uniform or not of linear material.
    """
    from ..solve.changes.along_path import pair_crossings
    from ..solve.point import FAILURES, cause_of

    try:
        found = pair_crossings(path, 0.0, end)
    except FAILURES as error:
        raise FlutterUnknown(
            f"the search for the flutter threshold of a relative load fails: {cause_of(error)}"
        ) from error
    first = min(
        (crossing.at for crossing in found.crossings if crossing.kind == ChangeKind.hopf), default=inf
    )
    if not found.proved or (found.ended_early and first == inf):
        raise FlutterUnknown(
            "the flutter threshold of a relative load is not decided: a Hopf point may be missing"
        )
    return first


def _grows(path: Path, zero: LocatedZero) -> bool:
    """Whether the growth rate of the pair on the imaginary axis increases with F."""
    there = determinant_along(
        complex(0.0, zero.eta_or_x), coefficients_at(zero.p, path.origin, path.direction), path.direction
    )
    return bool((-there.D_p / there.D_w).real > 0)
