"""The task thresholds: the forces at which the spectrum of every rod changes its kind."""

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from ...config import ThresholdsConfig
from ...results.layouts.variables import Filled
from ...sweep.estimate import Estimate, estimate_lines
from ...sweep.grid import Points
from .crossings import first_of, search_record
from .parts import LEFT_OUT, certificate_part, count_of, rod_parts
from .protocol import Part, Solver

if TYPE_CHECKING:
    from ...solve.changes.thresholds import Thresholds


@dataclass(frozen=True, slots=True)
class ThresholdsTask:
    """Thresholds of every rod."""

    config: ThresholdsConfig
    points: Points

    def coordinates(self) -> dict[str, np.ndarray]:
        return {}

    def constants(self) -> tuple[Filled, ...]:
        return ()

    def headline(self) -> str:
        F_max = self.config.thresholds.F_max
        return f"{count_of(self.points)}, each searched from F = 0 to {F_max:g}, or to just below k1"

    def parts(self) -> list[Part]:
        options = self.config.thresholds
        return [
            *rod_parts(dict(zip(self.points.names, self.points.columns, strict=True))),
            ("onset, Hopf points, restabilization", True, "task: thresholds"),
            ("all other crossings", True, f"at most {options.crossings} are stored for each point"),
            certificate_part("thresholds", options.certify, "crossings may be missed"),
            LEFT_OUT,
        ]

    def cost(self) -> Estimate:
        return estimate_lines(self.points.count, self.config.thresholds.certify)

    def solver(self) -> Solver:
        from ...solve.changes.thresholds import ThresholdsRequest, ThresholdStatus, solve_thresholds, warm_up

        options = self.config.thresholds
        request = ThresholdsRequest(options.F_max, self.config.accuracy, options.certify, options.crossings)
        return Solver(
            statuses=tuple(ThresholdStatus),
            warm_up=warm_up,
            solve=lambda index: solve_thresholds(**self.points.values(index), request=request),
            record=lambda index, result: record(result, options.crossings),
        )


def record(result: "Thresholds", most: int) -> dict[str, Any]:
    """Thresholds as the variables of the file."""
    onset = first_of(result.crossings, "onset")
    hopf = first_of(result.crossings, "hopf")
    end = first_of(result.crossings, "restabilization")
    return {
        "F_onset": onset.at if onset else np.nan,
        "onset_growth_rate": onset.growth_rate if onset else np.nan,
        "F_hopf": hopf.at if hopf else np.nan,
        "hopf_frequency": hopf.frequency if hopf else np.nan,
        "F_restabilization": end.at if end else np.nan,
        "restabilization_frequency": end.frequency if end else np.nan,
        "F_end": result.end,
        "unstable_at_end": result.transitions.unstable_at_end,
    } | search_record(result, most, "crossing_F")
