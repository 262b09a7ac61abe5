"""What a portrait is drawn from: the results of one rod, and the reasons where a result is missing."""

from collections.abc import Mapping
from dataclasses import dataclass

from ...results.file.view import View


@dataclass(frozen=True, slots=True, kw_only=True)
class RodResults:
    """Results of one rod.

    parameters: of the rod, by name. F_max: largest force. views: results by task; modes are at the thresholds
    of `mode_forces`, by kind, and limit cycles at some forces with stable cycles. missing: for every task
    without a result, the reason in a sentence.
    """

    parameters: Mapping[str, float]
    F_max: float
    views: Mapping[str, View]
    mode_forces: Mapping[str, float]
    missing: Mapping[str, str]
