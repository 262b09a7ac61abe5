"""First flutter of arms whose load is relative to it: known before the points are made, once for each rod.

The search takes most of the time in which points are made, so the ranks of a run may share it. A search that
fails gives its points a status. The solver is imported on demand.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from math import inf, nan
from typing import TypeAlias

from ...config.arm.axes import UncoveredArm
from ...config.arm.section import ArmSection
from ...errors import InputError
from ...model.arm.arm import SlenderArm
from ...model.arm.quantities import RELATIVE
from ...model.material.build import Build
from ...model.rod import Rod


@dataclass(frozen=True, slots=True)
class FlutterForce:
    """F of first flutter at the likeliest drag: inf without flutter, NaN if the search fails, and why."""

    F: float
    failure: str = ""


FlutterForces: TypeAlias = Mapping[Rod, FlutterForce]
"""Flutter of rods that move in one plane, without load."""
Tapers: TypeAlias = Sequence[float | None]
"""Tip radius over base radius beside a section, None where the arm has its own."""
OWN_TAPER: Tapers = (None,)


def rods_of_flutter(
    section: ArmSection | None, build: Build | None = None, tapers: Tapers = OWN_TAPER
) -> list[Rod]:
    """The different rods whose flutter the points of a section need; none unless its load is relative.

    build: law and profile beside the section. Raises InputError for an arm that is refused.
    """
    if section is None or section.load_axis not in RELATIVE:
        return []
    from ...verdict.relative import plane_rods

    shapes = ((arm, taper) for arm in _arms(section) for taper in tapers)
    return list(dict.fromkeys(rod for arm, taper in shapes for rod, _ in plane_rods(arm, build, taper)))


def _arms(section: ArmSection) -> Iterable[SlenderArm]:
    """Arms of a section that a rod covers, without load."""
    for values in section.sections():
        try:
            yield section.made(values)
        except UncoveredArm:
            continue
        except ValueError as error:
            raise InputError(str(error)) from None


def flutter_of_rod(rod: Rod) -> FlutterForce:
    """Flutter of one rod; a failure is an outcome, not an exception."""
    from ...verdict.relative import FlutterSearchFailed, first_hopf_force

    try:
        return FlutterForce(first_hopf_force(rod))
    except FlutterSearchFailed as error:
        return FlutterForce(nan, str(error))


def flutter_of_arm(
    arm: SlenderArm, taper: float | None, known: FlutterForces, build: Build | None = None
) -> FlutterForce:
    """Flutter of an arm, in its k3/L^2: the smallest over its planes, a failure if one of them fails.

    taper: in place of the arm's. build: as in `rods_of_flutter`.
    """
    from ...verdict.relative import plane_rods

    first = inf
    for rod, scale in plane_rods(arm, build, taper):
        found = known[rod]
        if found.failure:
            return found
        first = min(first, found.F * scale)
    return FlutterForce(first)
