"""What a search along one parameter found, as variables of the file: the same for a rod and for a row."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from ...results.layouts.crossings import CROSSING_KINDS

if TYPE_CHECKING:
    from ...solve.changes.thresholds import Thresholds
    from ...solve.changes.unstable_modes import Crossing


def search_record(result: "Thresholds", most: int, at: str) -> dict[str, Any]:
    """The variables of a search: at most `most` crossings, whose place is the variable `at`."""
    found = result.transitions
    return {
        "crossing_count": len(found.crossings),
        "open_from": found.open_range[0],
        "open_to": found.open_range[1],
        "certified": found.proved,
        "boxes": found.boxes,
        "solves": found.solves,
        "seconds": result.seconds,
        "status": int(result.status),
    } | _along_crossing(result.crossings[:most], most, at)


def first_of(crossings: "Sequence[Crossing]", kind: str) -> "Crossing | None":
    """The first crossing of a kind."""
    number = CROSSING_KINDS.index(kind)
    return next((crossing for crossing in crossings if crossing.kind == number), None)


def _along_crossing(crossings: "Sequence[Crossing]", most: int, at: str) -> dict[str, Any]:
    """The variables along `crossing`, filled up to `most`."""
    columns: dict[str, tuple[str, float]] = {
        at: ("at", np.nan),
        "crossing_kind": ("kind", 0),
        "crossing_frequency": ("frequency", np.nan),
        "crossing_growth_rate": ("growth_rate", np.nan),
        "crossing_error": ("error", np.nan),
        "unstable_after": ("unstable_after", -1),
    }
    spare = most - len(crossings)
    return {
        name: [getattr(crossing, field) for crossing in crossings] + [fill] * spare
        for name, (field, fill) in columns.items()
    }
