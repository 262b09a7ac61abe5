"""Planes in which an arm can bend, and the plane in which it flutters at the smallest load."""

from dataclasses import dataclass, replace
from math import inf
from typing import Any, TypeVar

from ..errors import InputError
from ..model.arm.arm import SlenderArm
from ..model.arm.quantities import UNITS_AND_EXAMPLES
from ..model.units import with_si_prefix
from ..solve.changes.threshold_kinds import ThresholdKind
from .flutter_over_drags import ThresholdsOverDrags, thresholds_over_drags
from .relative_load import with_exchanged_sides

AnyArm = TypeVar("AnyArm", bound=SlenderArm)


@dataclass(frozen=True, slots=True)
class PlaneOfMotion:
    """Motion of an arm in one plane, with its thresholds for every drag."""

    arm: SlenderArm
    """The arm, with its cross-section turned so that the section's height lies in the plane of motion."""
    thresholds: ThresholdsOverDrags
    """Thresholds for bending in this plane."""
    name: str = ""
    """Name of the plane, such as "the plane of its height"; empty if all planes of motion are equivalent."""

    @property
    def flutter_load_by_drag(self) -> list[float]:
        """Force of the first flutter, in N, for each drag; inf for a drag without flutter."""
        forces = [thresholds.first_force(ThresholdKind.hopf) for thresholds in self.thresholds.by_drag]
        return [inf if force is None else force * self.arm.force_scale for force in forces]


@dataclass(frozen=True, slots=True)
class PlanesOfMotion:
    """Planes in which an arm can bend. first_to_flutter: plane with the smaller flutter load for the most
    likely drag. second: the other plane; None if all planes are equivalent."""

    first_to_flutter: PlaneOfMotion
    second: PlaneOfMotion | None = None

    @property
    def is_first_lowest_for_every_drag(self) -> bool:
        """Whether, for every drag, the flutter load in the plane `first_to_flutter` is not larger than in
        `second`; True without a second plane."""
        if self.second is None:
            return True
        loads = zip(self.first_to_flutter.flutter_load_by_drag, self.second.flutter_load_by_drag, strict=True)
        return all(first_load <= second_load for first_load, second_load in loads)


def planes_of(arm: SlenderArm) -> PlanesOfMotion:
    """Planes of motion of an arm, each with its solved thresholds: two for a rectangular section with unequal
    sides, in order of the flutter load for the likeliest drag; otherwise one."""
    if arm.is_equally_stiff_in_all_planes:
        return PlanesOfMotion(PlaneOfMotion(arm, thresholds_over_drags(arm)))
    exchanged = with_exchanged_sides(arm)
    height_plane = PlaneOfMotion(arm, thresholds_over_drags(arm), "the plane of its height")
    width_plane = PlaneOfMotion(exchanged, thresholds_over_drags(exchanged), "the plane of its width")
    # In newtons, since each plane has its own unit of force.
    if width_plane.flutter_load_by_drag[0] < height_plane.flutter_load_by_drag[0]:
        return PlanesOfMotion(width_plane, height_plane)
    return PlanesOfMotion(height_plane, width_plane)


def with_absolute_load(planes: PlanesOfMotion) -> PlanesOfMotion:
    """The planes, with the arm's load in a physical unit if it was relative to the flutter load. The flutter
    load is the smallest over all planes, for the most likely drag. Raises InputError if the arm does not
    flutter."""
    first = planes.first_to_flutter
    ratio = first.arm.load_over_flutter
    load = first.arm.load_name
    if ratio is None or load is None:
        return planes
    force = first.thresholds.by_drag[0].first_force(ThresholdKind.hopf)
    scale = first.arm.load_scale
    if force is None:
        end_text = f"{float(f'{first.thresholds.end * scale:.3g}'):g} {UNITS_AND_EXAMPLES[load][0]}"
        raise InputError(
            f"{load} = '{getattr(first.arm, load)}' cannot be computed: with the likeliest drag the arm does "
            f"not flutter up to {end_text}; give an absolute load"
        )
    factor, unit = with_si_prefix(ratio * force * scale, UNITS_AND_EXAMPLES[load][0])
    # As text with a unit, because a bare number would be read in SI units and lose the user's scale.
    absolute_load: dict[str, Any] = {load: f"{ratio * force * scale * factor:.15g} {unit}"}
    second = planes.second and replace(planes.second, arm=replace(planes.second.arm, **absolute_load))
    return PlanesOfMotion(replace(first, arm=replace(first.arm, **absolute_load)), second)


def arm_with_absolute_load(arm: AnyArm) -> AnyArm:
    """The arm with its load in a physical unit. Solves for the flutter load if the load is relative to the
    flutter load; raises InputError if such an arm does not flutter."""
    load = arm.load_name
    if load is None or arm.load_over_flutter is None:
        return arm
    return replace(arm, **{load: getattr(with_absolute_load(planes_of(arm)).first_to_flutter.arm, load)})
