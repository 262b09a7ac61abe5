"""The task criticality: the normal form of every Hopf point of every rod."""

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from ..config.criticality import CriticalityConfig
from ..results.layouts.criticality import NORMAL_FORM, OF_NO_HOPF_POINT
from ..sweep.estimate import Estimate, estimate_criticality
from .parts import count_of, rod_parts
from .protocol import Part, Solver, Task
from .thresholds import search_record

if TYPE_CHECKING:
    from ..solve.hopf.criticality import Criticality
    from ..solve.hopf.hopf_coefficients import HopfCoefficients


@dataclass(frozen=True, slots=True)
class CriticalityTask(Task):
    """Hopf points and their normal forms."""

    config: CriticalityConfig

    def headline(self) -> str:
        F_max = self.config.criticality.F_max
        return f"{count_of(self.points)}, each searched from F = 0 to {F_max:g}, or to just below k1"

    def parts(self) -> list[Part]:
        options = self.config.criticality
        why = (
            "winding number of D"
            if options.certify
            else "criticality.certify: false; Hopf points may be missed"
        )
        return [
            *rod_parts(self.points.of_rods),
            ("axial drag", True, "parameters.gamma1; it moves no Hopf point, and every cycle"),
            (
                "Hopf points and their normal forms",
                True,
                f"at most {options.crossings} are stored for each rod",
            ),
            ("cycles", False, "to third order in their amplitude only; task: limit_cycle computes them"),
            ("certificate", options.certify, why),
            ("gravity, inertia, motion out of the plane", False, "not part of the overdamped problem"),
        ]

    def cost(self) -> Estimate:
        return estimate_criticality(self.points.count, self.config.criticality.certify)

    def solver(self) -> Solver:
        from ..solve.hopf.criticality import (
            CriticalityRequest,
            CriticalityStatus,
            solve_criticality,
            warm_up,
        )

        options = self.config.criticality
        request = CriticalityRequest(options.F_max, self.config.accuracy, options.certify, options.crossings)
        return Solver(
            statuses=tuple(CriticalityStatus),
            warm_up=warm_up,
            solve=lambda index: solve_criticality(self.points.rod(index), request),
            record=lambda index, result: record(result, options.crossings),
        )


def record(result: "Criticality", most: int) -> dict[str, Any]:
    """A Criticality as the variables of the file."""
    search = search_record(result, most, "crossing_F")
    for name in OF_NO_HOPF_POINT:
        del search[name]
    rows = [
        _along(coefficients) | {"crossing_frequency_error": hopf.frequency_error}
        for coefficients, hopf in zip(result.coefficients, result.crossings, strict=False)
    ]
    empty = [{v.name: v.fill for v in NORMAL_FORM}] * (most - len(rows))
    along = {v.name: [row[v.name] for row in [*rows, *empty]] for v in NORMAL_FORM}
    ends = {"F_end": result.end, "unstable_at_end": result.transitions.unstable_at_end}
    return search | ends | along


def _along(coefficients: "HopfCoefficients") -> dict[str, Any]:
    """The coefficients of one Hopf point by the names of their variables."""
    c, slope = coefficients.landau, coefficients.growth_slope
    named = {v.name: getattr(coefficients, v.name, None) for v in NORMAL_FORM}
    return named | {
        "growth_slope_real": slope.real,
        "growth_slope_imag": slope.imag,
        "landau_real": c.real,
        "landau_imag": c.imag,
    }
