"""Thresholds of the part of a row that can be searched. A row consists of rods that differ in one parameter
only; some rows along F begin at a strong pull.

Under a strong pull no a-priori bound may apply, or no mesh may resolve the leading eigenvalues. The search of
a row along F then begins at a smaller pull.
"""

from dataclasses import replace
from typing import NamedTuple

from ....arrays import Array, list_of
from ....determinant.parameter_path import ParameterPath
from ....model.rod import Rod
from ...unsolvable import Unsolvable
from ..thresholds_along_path import ThresholdSearchResult, find_thresholds


class SolvablePartSearch(NamedTuple):
    """Search of a row (rods that differ in one parameter only) that starts at one of its parameter values.
    result: None if nothing could be searched. failure: why nothing could be searched, or why a search along F
    ended early at a pull, F < 0; empty otherwise."""

    result: ThresholdSearchResult | None
    failure: str = ""


def thresholds_of_solvable_part(
    rod: Rod, name: str, inner_values: Array, row_ends: tuple[float, float], certify: bool
) -> ThresholdSearchResult:
    """Thresholds of the rods that differ from `rod` only in the parameter `name` (a row), between its values
    `row_ends`.

    If a row along F cannot be searched from its first pull on, the search begins at the first value of the
    row from which a search is possible, or at F = 0. inner_values: increasing values of the row between its
    ends, (n,). certify: whether a proof is requested. Raises Unsolvable if the row cannot be searched, not
    even from F = 0 on.
    """
    start, stop = row_ends
    first_search = _search_along_row(rod, name, row_ends, certify)
    if not first_search.failure and first_search.result is not None:
        return first_search.result
    later_starts: list[float] = []
    if name == "F":
        later_starts = [*list_of(inner_values[inner_values < 0]), *([0.0] if start < 0 < stop else [])]
    # If even the latest start fails, no part of the row can be searched.
    last_search = (
        _search_along_row(rod, name, (later_starts[-1], stop), certify) if later_starts else first_search
    )
    if last_search.result is None:
        raise Unsolvable(last_search.failure)
    if not later_starts:
        return last_search.result
    # Bisection for the first value from which the row can be searched; a search from starts[solved_index]
    # succeeds.
    starts = [start, *later_starts]
    failure = first_search.failure
    failed_index = 0
    solved_index = len(later_starts)
    while solved_index - failed_index > 1:
        middle_index = (failed_index + solved_index) // 2
        search = _search_along_row(rod, name, (starts[middle_index], stop), certify)
        if search.failure:
            failed_index = middle_index
            failure = search.failure
        else:
            solved_index = middle_index
            last_search = search
    result = last_search.result or first_search.result
    assert result is not None
    message = (
        f"the search begins at F = {starts[solved_index]:.12g}, because a search from "
        f"F = {starts[failed_index]:.12g} fails: {failure}"
    )
    return replace(result, ended_early=True, doubt_text="; ".join(filter(None, (message, result.doubt_text))))


def _search_along_row(
    rod: Rod, name: str, row_ends: tuple[float, float], certify: bool
) -> SolvablePartSearch:
    """Search along the rods that differ from `rod` only in the parameter `name`, between its values
    `row_ends`; a search along F that ends early at a pull, F < 0, is a failure."""
    try:
        result = find_thresholds(
            ParameterPath(rod.with_values(**{name: row_ends[0]}), name), *row_ends, certify
        )
    except Unsolvable as failure:
        return SolvablePartSearch(None, str(failure))
    ends_early = name == "F" and result.ended_early and result.searched_interval[1] < min(row_ends[1], 0)
    return SolvablePartSearch(result, result.doubt_text if ends_early else "")
