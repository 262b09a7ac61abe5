"""The two regions beyond the ends of a range in which branches are followed."""

from dataclasses import replace

from ...determinant.parameter_path import ParameterPath
from ...discretization.stress.form import has_small_rotational_drag
from ...model.crushing import uncrushed_interval
from ...model.parameters import PARAMETERS
from .branch_end_reason import BranchEndReason
from .branch_limits import BranchLimits
from .region_beyond import BEYOND_RANGE_SETTINGS, RegionBeyond


def regions_beyond(path: ParameterPath, limits: BranchLimits, margin: float) -> list[RegionBeyond]:
    """The regions beyond the ends of the range of `limits`. margin: smallest relative distance from the
    crushing force."""
    regions = (_region(path, index, limits, margin) for index in (0, 1))
    return [region for region in regions if region is not None]


def _region(path: ParameterPath, index: int, limits: BranchLimits, margin: float) -> RegionBeyond | None:
    """The region beyond the end `index` of the range, within the allowed values of the parameter; None at a
    crushed rod and at a coordinate of 0 or less. margin: see `regions_beyond`."""
    end = limits.coordinate_range[index]
    if end <= 0 or limits.end_reasons[index] is BranchEndReason.crushed:
        return None
    far_end = _far_end(end, index, path.name)
    low, high = sorted(map(path.parameter.value, (end, far_end)))
    bounds = path.parameter.allowed.schema_bounds
    low, high = max(bounds.get("minimum", low), low), min(bounds.get("maximum", high), high)
    rod = {"F": path.rod.F, "k1": path.rod.k1, "taper": path.rod.taper}
    low, high = uncrushed_interval(path.rod.material, rod, (path.name, low, high), margin)
    far_end = (min, max)[index](path.coordinate(low), path.coordinate(high))
    # The unknowns of a branch cannot change within the branch.
    is_small = has_small_rotational_drag(path.rod_at(far_end))
    if not low < high or is_small and not limits.keeps_omega:
        return None
    region_limits = replace(
        limits,
        hopfs=(),
        coordinate_range=(end, far_end) if index == 1 else (far_end, end),
        end_reasons=(BranchEndReason.range_end, BranchEndReason.range_end),
        max_cycles=BEYOND_RANGE_SETTINGS.max_cycles,
        locates_special_points=False,
    )
    return RegionBeyond(path, index, limits, region_limits)


def _far_end(end: float, index: int, name: str) -> float:
    """Coordinate of the parameter `name` at the far end of the region beyond the end `end` of a range, which
    is not negative. index: 0 below the range, 1 above."""
    factor = 1 + BEYOND_RANGE_SETTINGS.relative_extent
    return end * factor if index == 1 else end / factor * (name != "F")


def extended_range(name: str, low: float, high: float) -> tuple[float, float]:
    """Smallest and largest value of the parameter `name` up to which branches are followed beyond the range
    from `low` to `high`; crushed rods are not considered."""
    parameter = PARAMETERS[name]
    ends = sorted(float(parameter.coordinate(value)) for value in (low, high))
    far_ends = [end if end <= 0 else _far_end(end, index, name) for index, end in enumerate(ends)]
    values = [float(parameter.value(end)) for end in far_ends]
    return min(values), max(values)
