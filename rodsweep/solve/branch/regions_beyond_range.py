"""The two regions beyond the ends of a range in which branches are followed."""

from dataclasses import replace
from math import isnan

from ...determinant.parameter_path import ParameterPath
from ...discretization.stress.form import has_small_rotational_drag
from ...model.crushing import uncrushed_interval
from ...model.parameters import PARAMETERS
from ..changes.thresholds_along_path import ThresholdSearchResult, find_imaginary_axis_crossings
from ..point_outcome import FAILURE_EXCEPTIONS
from .branch_limits import BranchLimits
from .region_beyond_range import RegionBeyondRange
from .settings import BEYOND_RANGE_SETTINGS
from .start.hopf_point import HopfBranchStart, hopf_branch_start
from .status import BranchEndReason


def regions_beyond_range(path: ParameterPath, limits: BranchLimits, margin: float) -> list[RegionBeyondRange]:
    """The regions next to the lower and the upper end of the parameter range of `limits`, in which branches
    are followed on; a region that does not exist is left out. path: rods along the parameter. margin:
    smallest relative distance of the force from the crushing force."""
    regions = (_region_beyond_range_end(path, index, limits, margin) for index in (0, 1))
    return [region for region in regions if region is not None]


def _region_beyond_range_end(
    path: ParameterPath, index: int, limits: BranchLimits, margin: float
) -> RegionBeyondRange | None:
    """The region next to the end `index` (0: lower, 1: upper end of the coordinate) of the range of `limits`,
    within the allowed values of the parameter. None if the coordinate at this end is 0 or less, if the force
    nearly crushes the rod there, or if no rod that the branch can reach lies beyond. margin: as in
    `regions_beyond_range`."""
    end = limits.coordinate_range[index]
    if end <= 0 or limits.end_reasons[index] is BranchEndReason.crushed:
        return None
    far_end = _far_end_of_region(end, index, path.parameter_name)
    low, high = sorted(map(path.parameter.value, (end, far_end)))
    bounds = path.parameter.allowed_range.schema_bounds
    low = max(bounds.get("minimum", low), low)
    high = min(bounds.get("maximum", high), high)
    # The path moves one parameter; the two others of the crushing load keep the values of the rod.
    base_values = {"F": path.rod.F, "k1": path.rod.k1, "taper": path.rod.taper}
    low, high = uncrushed_interval(path.rod.material, base_values, (path.parameter_name, low, high), margin)
    # Along a compliance the larger value has the smaller coordinate, so coordinates are compared.
    farther = min if index == 0 else max
    far_end = farther(path.coordinate(low), path.coordinate(high))
    # The unknowns of a branch cannot change within the branch.
    has_small_drag = has_small_rotational_drag(path.rod_at(far_end))
    if not low < high or has_small_drag and not limits.is_omega_always_unknown:
        return None
    region_limits = replace(
        limits,
        hopfs_beyond_range=limits.hopfs,
        # The range is ordered by coordinate; the region touches the range at its upper or at its lower end.
        coordinate_range=(end, far_end) if index == 1 else (far_end, end),
        end_reasons=(BranchEndReason.range_end, BranchEndReason.range_end),
        max_cycles=BEYOND_RANGE_SETTINGS.max_cycles,
        locates_special_points=False,
    )
    hopfs, lost_at = _hopf_points_and_search_ends(path, index, region_limits)
    region = RegionBeyondRange(path, index, limits, replace(region_limits, hopfs=hopfs))
    for coordinate in lost_at:
        region.shorten_followed_part(coordinate)
    return region


def _hopf_points_and_search_ends(
    path: ParameterPath, index: int, limits: BranchLimits
) -> tuple[list[HopfBranchStart], list[float]]:
    """Returns (Hopf points in the region of `limits`, coordinates). Beyond each of the coordinates, as seen
    from the range, Hopf points may be missing. index: 0 for the region below the range, 1 above. limits:
    limits of the region; their `hopfs_beyond_range` are the Hopf points within the range."""
    low, high = sorted(map(path.parameter.value, limits.coordinate_range))
    try:
        search = find_imaginary_axis_crossings(path, low, high, certify=False)
    except FAILURE_EXCEPTIONS:
        # Hopf points may be missing everywhere, so nothing beyond the end of the range counts as searched.
        return [], [limits.coordinate_range[1 - index]]
    hopfs = []
    lost_at = _ends_of_complete_hopf_search(path, index, limits, search)
    for crossing in search.thresholds:
        others = (hopf.crossing for hopf in limits.hopfs_beyond_range)
        # A Hopf point at the end of the range is found by both searches, and belongs to the range.
        if any(abs(crossing.value - other.value) <= crossing.error + other.error for other in others):
            continue
        try:
            hopfs.append(
                hopf_branch_start(path, crossing, limits.is_omega_always_unknown, limits.min_coordinate_unit)
            )
        except FAILURE_EXCEPTIONS:
            lost_at.append(path.coordinate(crossing.value))
    return hopfs, lost_at


def _ends_of_complete_hopf_search(
    path: ParameterPath, index: int, limits: BranchLimits, search: ThresholdSearchResult
) -> list[float]:
    """Coordinates beyond which, as seen from the range, Hopf points may be missing in the result `search`.
    path, index, limits: as in `_hopf_points_and_search_ends`."""
    ends = []
    if search.ended_early:
        # The search begins at the smallest coordinate.
        end = max(map(path.coordinate, search.searched_interval))
        # Below the range the missing part is the one next to the range, so nothing there counts as searched.
        ends.append(end if index == 1 else limits.coordinate_range[1])
    if not isnan(search.range_of_further_crossings[0]):
        unsearched = [path.coordinate(value) for value in search.range_of_further_crossings]
        ends.append(min(unsearched) if index == 1 else max(unsearched))
    return ends


def _far_end_of_region(end: float, index: int, name: str) -> float:
    """Parameter coordinate at the end of a region that is farther from the range. end: coordinate at the end
    of the range where the region begins, not negative. index: 0 for the region below the range, 1 above.
    name: parameter."""
    factor = 1 + BEYOND_RANGE_SETTINGS.extent_over_largest_coordinate
    # Along the force the region ends at 0, from below which no cycle comes.
    return end * factor if index == 1 else end / factor * (name != "F")


def extended_range(name: str, low: float, high: float) -> tuple[float, float]:
    """Smallest and largest value of the parameter `name` up to which branches are followed beyond
    the range from `low` to `high`; crushed rods are not considered."""
    parameter = PARAMETERS[name]
    ends = sorted(float(parameter.coordinate(value)) for value in (low, high))
    # An end at 0 or below has no region beyond it, as in `_region_beyond_range_end`.
    far_ends = [end if end <= 0 else _far_end_of_region(end, index, name) for index, end in enumerate(ends)]
    values = [float(parameter.value(end)) for end in far_ends]
    return min(values), max(values)
