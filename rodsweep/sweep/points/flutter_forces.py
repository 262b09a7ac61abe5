"""First flutter force of arms whose load is given relative to flutter, solved once per rod before the sweep.

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
    """Force F of first flutter with the likeliest drag: inf without flutter, NaN after a failed search.

    failure: why the search failed; empty otherwise."""

    F: float
    failure: str = ""


FlutterForces: TypeAlias = Mapping[Rod, FlutterForce]
"""Flutter force by rod; the rods have no load and move in one plane."""
Tapers: TypeAlias = Sequence[float | None]
"""Values of the parameter `taper` (tip radius over base radius) given beside an arm; None keeps the taper of
the arm."""
OWN_TAPER: Tapers = (None,)


def rods_of_flutter(
    section: ArmSection | None, build: Build | None = None, tapers: Tapers = OWN_TAPER
) -> list[Rod]:
    """Distinct rods whose flutter force the points of `section` need; empty unless its load is relative.

    build: law and profile given beside the section, None for those of the arm. Raises InputError for an
    invalid arm.
    """
    if section is None or section.load_axis not in RELATIVE:
        return []
    from ...verdict.relative import plane_rods

    shapes = ((arm, taper) for arm in _arms(section) for taper in tapers)
    return list(dict.fromkeys(rod for arm, taper in shapes for rod, _ in plane_rods(arm, build, taper)))


def _arms(section: ArmSection) -> Iterable[SlenderArm]:
    """Yields the arms of a section to which the rod model applies, without their load."""
    for values in section.sections():
        try:
            yield section.made(values)
        except UncoveredArm:
            continue
        except ValueError as error:
            raise InputError(str(error)) from None


def flutter_of_rod(rod: Rod) -> FlutterForce:
    """Flutter force of one rod; a failed search is returned as a `FlutterForce`, not raised."""
    from ...verdict.relative import FlutterSearchFailed, first_hopf_force

    try:
        return FlutterForce(first_hopf_force(rod))
    except FlutterSearchFailed as error:
        return FlutterForce(nan, str(error))


def flutter_of_arm(
    arm: SlenderArm, taper: float | None, known: FlutterForces, build: Build | None = None
) -> FlutterForce:
    """Smallest flutter force of an arm over its planes of motion; a failure if any plane fails.

    taper: replaces the taper of the arm, unless None. known: flutter forces of the arm's rods. build: as in
    `rods_of_flutter`.
    """
    from ...verdict.relative import plane_rods

    first = inf
    for rod, scale in plane_rods(arm, build, taper):
        found = known[rod]
        if found.failure:
            return found
        first = min(first, found.F * scale)
    return FlutterForce(first)
