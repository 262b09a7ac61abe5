"""The task thresholds: the forces at which the spectrum of every rod changes its kind."""

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from ...config.thresholds import ThresholdsConfig
from ...sweep.estimate import Estimate, estimate_lines
from .crossings import first_of, search_record
from .parts import LinearTask, count_of
from .protocol import Part, Solver

if TYPE_CHECKING:
    from ...solve.changes.thresholds import Thresholds


@dataclass(frozen=True, slots=True)
class ThresholdsTask(LinearTask):
    """Thresholds of every rod."""

    config: ThresholdsConfig

    not_proved: ClassVar[str] = "crossings may be missed"

    def headline(self) -> str:
        F_max = self.config.thresholds.F_max
        return f"{count_of(self.points)}, each searched from F = 0 to {F_max:g}, or to just below k1"

    def asked(self) -> list[Part]:
        most = self.config.thresholds.crossings
        return [
            ("onset, Hopf points, restabilization", True, "task: thresholds"),
            ("all other crossings", True, f"at most {most} are stored for each point"),
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
