"""Forces of first flutter, for arms with a load relative to flutter, computed once for each rod.

The forces are needed to compute the points of a sweep. The search for flutter takes most of the time of this
computation, so the ranks of a run may divide the rods. If the search fails, the points get the status
`flutter_unknown`. The solver is imported on demand.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from math import inf, nan
from typing import TypeAlias

from ...config.arm.section import ArmConfig
from ...config.arm.status import ArmOutsideModel
from ...errors import InputError
from ...model.arm.arm import SlenderArm
from ...model.arm.quantities import LOAD_NAME_BY_RELATIVE_LOAD
from ...model.material.rod_material import RodMaterial
from ...model.rod import Rod


@dataclass(frozen=True, slots=True)
class FlutterForce:
    """Force F of first flutter at the likeliest drag, in k3/L^2: inf if the rod does not flutter, nan if the
    search fails. failure: reason why the search failed, or empty."""

    F: float
    failure: str = ""


FlutterForceByRod: TypeAlias = Mapping[Rod, FlutterForce]
"""Force of first flutter by rod; the rods are without load and move in one plane."""
ReplacementTapers: TypeAlias = Sequence[float | None]
"""Tapers (tip radius over base radius) that replace an arm's taper; None keeps the arm's own taper."""
OWN_TAPER: ReplacementTapers = (None,)
"""No replacement: the arm keeps its own taper."""


def rods_needing_flutter_force(
    arm_config: ArmConfig | None, material: RodMaterial | None = None, tapers: ReplacementTapers = OWN_TAPER
) -> list[Rod]:
    """The distinct rods whose flutter forces the points of an arm need; empty if the load is not relative to
    flutter. material: constitutive law and profile from the config section `material`, None if the section is
    not given. tapers: each replaces the arm's taper in turn. Raises InputError for an invalid arm."""
    if arm_config is None or arm_config.load_key not in LOAD_NAME_BY_RELATIVE_LOAD:
        return []
    from ...verdict.relative_load import rods_and_force_scales_by_plane

    shapes = ((arm, taper) for arm in _unloaded_arms(arm_config) for taper in tapers)
    # A mapping drops equal rods and keeps their order, which must be the same on all ranks.
    return list(
        dict.fromkeys(
            rod for arm, taper in shapes for rod, _ in rods_and_force_scales_by_plane(arm, material, taper)
        )
    )


def _unloaded_arms(arm_config: ArmConfig) -> Iterable[SlenderArm]:
    """Yields the arms of a config section to which the model applies, without load. Raises InputError."""
    for values in arm_config.values_of_arms():
        try:
            yield arm_config.arm_of(values)
        except ArmOutsideModel:
            continue
        except ValueError as error:
            raise InputError(str(error)) from None


def flutter_force_of_rod(rod: Rod) -> FlutterForce:
    """Force of first flutter of one rod. If the search fails, F is nan and `failure` is the reason."""
    from ...verdict.relative_load import FlutterSearchFailed, first_hopf_force

    try:
        return FlutterForce(first_hopf_force(rod))
    except FlutterSearchFailed as error:
        return FlutterForce(nan, str(error))


def smallest_flutter_force_of_arm(
    arm: SlenderArm,
    taper: float | None,
    flutter_forces: FlutterForceByRod,
    material: RodMaterial | None = None,
) -> FlutterForce:
    """Force of first flutter of an arm, in k3/L^2 of the arm: the smallest force over the planes of motion.

    If the search failed in a plane, the failure is returned. taper: replaces the arm's taper unless None.
    flutter_forces: forces of all rods of `rods_needing_flutter_force`. material: constitutive law and profile
    from the config section `material`, None if the section is not given.
    """
    from ...verdict.relative_load import rods_and_force_scales_by_plane

    flutter_force = inf
    for rod, scale in rods_and_force_scales_by_plane(arm, material, taper):
        rod_force = flutter_forces[rod]
        # The failed plane might have the smaller force, so the other plane alone proves nothing.
        if rod_force.failure:
            return rod_force
        flutter_force = min(flutter_force, rod_force.F * scale)
    return FlutterForce(flutter_force)
