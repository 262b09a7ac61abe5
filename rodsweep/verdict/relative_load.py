"""Search for the flutter load to which a relative load refers: the smallest flutter load of all planes of
motion, for the most likely drag.

The search for a uniform arm of linear material must run without PETSc. The search for any other arm starts
PETSc; all MPI ranks must have started PETSc before such searches are divided among the ranks.
"""

from dataclasses import replace
from functools import cache
from math import inf
from typing import TypeVar

import numpy as np

from ..determinant.certificate.covering import zeros_and_open_boxes_of_covering
from ..determinant.certificate.first_crossing_boxes import first_crossing_boxes
from ..determinant.parameter_path import ParameterPath, coefficients_at, determinant_value_on_path
from ..determinant.roots.newton import LocatedEigenvalue
from ..errors import InputError
from ..model.arm.arm import SlenderArm
from ..model.arm.drag import Drag
from ..model.material.rod_material import RodMaterial
from ..model.rod import Rod
from ..solve.changes.search_range import search_end_below_crushing
from ..solve.changes.threshold_kinds import ThresholdKind

AnyArm = TypeVar("AnyArm", bound=SlenderArm)
SEARCH_END = 1000.0
"""Largest force of the search, in k3/L^2: 25 times the flutter force of a filament. An arm that a smaller
force crushes is searched only up to the crushing force."""
FIRST_SEARCH_END = 200.0
"""Largest force of the first search, in k3/L^2. Most arms flutter at a smaller force, and the first search
takes half the time of the full search."""
SEARCH_ENDS_OF_VARYING_ARM = (3.0, 10.0, 30.0, 100.0, 300.0, SEARCH_END)
"""Largest forces of successive searches, in k3/L^2 at the base, for an arm that is not uniform or not of
linear material. The search for a relative load ends with the first of these searches that finds flutter: far
beyond flutter, where many modes are unstable, a search takes up to half a minute for each drag."""
REFERENCE_FORCE_DIGITS = 10
"""Significant digits to which the reference force is rounded. Ten digits are more than the data of an arm
have, and few enough to be equal on all machines. A run resumed elsewhere then has the same points."""


class FlutterSearchFailed(InputError):
    """Raised if the search for the flutter load of a relative load fails; the message states the reason."""


def with_exchanged_sides(arm: AnyArm) -> AnyArm:
    """The arm turned by 90 degrees about its axis: width and height of its section are exchanged."""
    return replace(arm, width=arm.height, height=arm.width)


def rods_and_force_scales_by_plane(
    arm: SlenderArm, material: RodMaterial | None = None, taper: float | None = None
) -> list[tuple[Rod, float]]:
    """Pairs (rod, scale), one per plane of motion. rod: dimensionless rod without load, for the most likely
    drag. scale: k3/L^2 of the rod divided by k3/L^2 of the arm. material: constitutive law and profile.
    taper: ratio of tip to base radius. If given, `material` and `taper` replace the values of the arm."""
    planes = [(_rod_in_its_plane(arm, material, taper), 1.0)]
    if not arm.is_equally_stiff_in_all_planes:
        exchanged = with_exchanged_sides(arm)
        # Each plane has its own unit of force, as the bending stiffness differs.
        scale = exchanged.cross_section.second_moment / arm.cross_section.second_moment
        planes.append((_rod_in_its_plane(exchanged, material, taper), scale))
    return planes


def _rod_in_its_plane(arm: SlenderArm, material: RodMaterial | None, taper: float | None) -> Rod:
    """The arm as a rod that bends in the plane of the section's height. material: constitutive law and
    profile. taper: ratio of tip to base radius. None keeps the arm's material or taper."""
    rod = rod_with_drag(arm, arm.base_drag_estimates[0], material)
    return rod if taper is None else replace(rod, taper=taper)


def rod_with_drag(arm: SlenderArm, drag: Drag, material: RodMaterial | None = None) -> Rod:
    """The arm with the given drag as a dimensionless rod without load, which bends in the plane of the
    section's height. material: constitutive law and profile; None for the material of the arm."""
    parameters = {"k1": arm.k1, "k2": arm.k2, "gamma3": arm.gamma3_with(drag), "taper": arm.taper}
    return Rod(F=0.0, **parameters, material=material or arm.material_with_drag(drag))


@cache
def first_hopf_force(rod: Rod) -> float:
    """Smallest F at which a pair of modes of `rod` becomes unstable, rounded to REFERENCE_FORCE_DIGITS
    digits. inf if no pair becomes unstable up to the end of the search. Raises FlutterSearchFailed if the
    search overflows or cannot exclude a Hopf point at a smaller F."""
    path = ParameterPath(rod, "F")
    find_first = _first_hopf_force_by_boxes if rod.is_uniform_and_linear else _first_hopf_force_of_varying_arm
    try:
        for end in (
            (FIRST_SEARCH_END, SEARCH_END) if rod.is_uniform_and_linear else SEARCH_ENDS_OF_VARYING_ARM
        ):
            force = find_first(path, search_end_below_crushing(rod, end))
            if force < inf:
                # The last digits of a solution differ between machines, and with them all points of a sweep.
                return float(f"{force:.{REFERENCE_FORCE_DIGITS}g}")
    except (ArithmeticError, MemoryError, np.linalg.LinAlgError) as error:
        reason = str(error) or type(error).__name__
        raise FlutterSearchFailed(
            f"the search for the flutter threshold to which a relative load refers fails: {reason}; give an "
            "absolute load"
        ) from error
    return inf


def _first_hopf_force_by_boxes(path: ParameterPath, end_force: float) -> float:
    """Smallest F up to `end_force` at which a pair of modes becomes unstable; inf if no pair does. Covers the
    zeros of the determinant with boxes. Raises FlutterSearchFailed if a smaller F is not excluded."""
    # Boxes exclude all smaller forces; following one mode from F = 0 could miss another one.
    boxes = first_crossing_boxes(path, 0.0, end_force)
    if boxes is None:
        raise FlutterSearchFailed(
            "the flutter threshold to which a relative load refers is not found, because no bound on the "
            "eigenvalues of this rod is known; give an absolute load"
        )
    zeros, undecided, _ = zeros_and_open_boxes_of_covering(boxes, path.origin, path.direction)
    force = min((zero.p for zero in zeros if _becomes_unstable(path, zero)), default=inf)
    # Undecided boxes beyond the first Hopf point cannot contain an earlier one.
    if any(min(box.p_from, box.p_to) < force for box in undecided):
        raise FlutterSearchFailed(
            "the flutter threshold to which a relative load refers is uncertain: a narrow window of flutter "
            "may lie below the first Hopf point found; give an absolute load"
        )
    return force


def _first_hopf_force_of_varying_arm(path: ParameterPath, end_force: float) -> float:
    """Smallest F up to `end_force` at which a pair of modes of an arm that is not uniform or not of linear
    material becomes unstable; inf if no pair does. Raises FlutterSearchFailed if the search along F fails or
    a smaller F is not excluded."""
    from ..solve.changes.thresholds_along_path import find_imaginary_axis_crossings
    from ..solve.point_outcome import FAILURE_EXCEPTIONS, cause_of

    try:
        located = find_imaginary_axis_crossings(path, 0.0, end_force)
    except FAILURE_EXCEPTIONS as error:
        raise FlutterSearchFailed(
            "the search for the flutter threshold to which a relative load refers fails: "
            f"{cause_of(error)}; give an absolute load"
        ) from error
    force = min(
        (crossing.value for crossing in located.thresholds if crossing.kind == ThresholdKind.hopf),
        default=inf,
    )
    # A search that ended early, but after the first Hopf point, has found the requested force.
    if not located.is_proved or (located.ended_early and force == inf):
        raise FlutterSearchFailed(
            "the flutter threshold to which a relative load refers is uncertain, because a Hopf point may be "
            "missing; give an absolute load"
        )
    return force


def _becomes_unstable(path: ParameterPath, zero: LocatedEigenvalue) -> bool:
    """Whether the pair on the imaginary axis at `zero` becomes unstable as p grows: d Re w/dp > 0."""
    value = determinant_value_on_path(
        complex(0.0, zero.eta_or_x), coefficients_at(zero.p, path.origin, path.direction), path.direction
    )
    return bool((-value.D_p / value.D_w).real > 0)
