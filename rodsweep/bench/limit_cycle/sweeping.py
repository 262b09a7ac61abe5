"""Cost of a point of a sweep: the cycle of a rod, solved from a neighbour's cycle or without a neighbour.

The cost includes all work of the task limit_cycle: mesh, Newton's method, all Floquet multipliers, the
verdict and the error estimate. Errors are measured against the same cycle on meshes with errors of 1e-11.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from math import nan
from typing import Any

from ...model.parameters import NONLINEAR_ROD_PARAMETER_NAMES
from ...model.rod import Rod
from ...solve.cycle.accuracy.refinement import refined_cycle_of_any_period
from ...solve.cycle.cycle_of_neighbouring_rod import CycleStart
from ...solve.cycle.limit_cycle import CycleOutcome, CycleStatus, solve_cycle
from ...solve.orbit.matrix.linearisation import Linearisation
from ...solve.orbit.matrix.workspace import NewtonWorkspace
from ...solve.orbit.measures import CycleMotion
from ...solve.orbit.newton import solve_by_newton
from ...solve.orbit.orbit import Orbit
from ..study import (
    CaseWithErrorMeasure,
    Measurement,
    TimedMethod,
    grouped_by_fields,
    markdown_table,
    measure_cases,
    nan_median,
)
from .swept_rods import rod_label
from .tracking import REFERENCE_NEWTON_TOLERANCE, cycle_request, orbit_of

SWEPT_PARAMETERS = NONLINEAR_ROD_PARAMETER_NAMES[:2]
"""Parameters along which sweeps are timed; neighbouring points differ in one of these parameters."""
PARAMETER_STEP_RATIO = 1.01
"""Ratio of the parameter values of two neighbouring points of the sweep."""
WARM_UP_POINT_COUNT = 6
"""Number of untimed points before the timed points; the mesh is chosen during these points."""
TIMED_POINT_COUNT = 22
"""Number of timed points: the number of points from one measurement of the mesh errors to the next."""
ACCURACY, REFERENCE_ACCURACY = 1e-7, 1e-11
"""Relative accuracies of the cycles requested from rodsweep and of the reference cycles."""
SWEEP_PREFIX, COLD_PREFIX = "sweep over ", "cold, "
"""Prefixes, in the table, of the names of solutions from a neighbour's cycle and without a neighbour."""
COLD_STARTS = {"leading mode": "mode", "Hopf point": "hopf"}
"""Values of the option `start` for solutions without a neighbour, by name in the table."""
FAILED_POINT_CELLS = dict.fromkeys(
    ("period_error", "amplitude_error", "estimate", "multipliers", "order", "intervals", "stages"), nan
)
"""Values, nan, in the columns of the table for a failed point."""


@dataclass(frozen=True, eq=False)
class MeshConvergedCycle:
    """Reference cycle on a mesh with the relative accuracy REFERENCE_ACCURACY.

    orbit: the cycle. period: in tau2. tip_y_max: largest y of the tip in L.
    """

    orbit: Orbit
    period: float
    tip_y_max: float

    @classmethod
    def converged_from_orbit(cls, orbit: Orbit) -> "MeshConvergedCycle":
        """The reference cycle near the orbit `orbit`, for the rod of this orbit."""
        result = refined_cycle_of_any_period(orbit, REFERENCE_ACCURACY, NewtonWorkspace())
        return cls(result.orbit, result.measures.period, result.measures.tip_y_max)

    def cycle_at_force(self, F: float) -> "MeshConvergedCycle":
        """The reference cycle of the same rod at the force F, which must be close to the current force."""
        stress_form = self.orbit.form
        moved_orbit = replace(self.orbit, form=replace(stress_form, rod=replace(stress_form.rod, F=F)))
        orbit = solve_by_newton(moved_orbit, REFERENCE_NEWTON_TOLERANCE, NewtonWorkspace()).orbit
        return MeshConvergedCycle(orbit, orbit.period, CycleMotion(orbit).tip_extrema["tip_y_max"])

    def errors_of(self, period: float, tip_y_max: float) -> dict[str, float]:
        """Relative errors of a computed period, in tau2, and largest tip y, in L, by name of the column."""
        return {
            "period_error": abs(period / self.period - 1),
            "amplitude_error": abs(tip_y_max / self.tip_y_max - 1),
        }


@dataclass(frozen=True, eq=False)
class SweptRod:
    """A rod at which timed sweeps end. reference_cycle: reference cycle of the rod. start_cycle_by_parameter:
    cycle from which the timed sweep starts, by swept parameter. workspace: memory of Newton's matrices,
    shared by all points.
    """

    rod: Rod
    reference_cycle: MeshConvergedCycle
    start_cycle_by_parameter: dict[str, CycleStart | None]
    workspace: NewtonWorkspace


def swept_rod(rod: Rod, accuracy: float) -> SweptRod:
    """The rod `rod` with its reference cycle and, for each sweep, the cycle of the last untimed point.
    accuracy: relative accuracy of the cycles."""
    neighbours: dict[str, CycleStart | None] = {}
    workspace = NewtonWorkspace()
    for parameter_name in SWEPT_PARAMETERS:
        neighbour: CycleStart | None = None
        for k in range(WARM_UP_POINT_COUNT, 0, -1):
            earlier = rod_earlier_in_sweep(rod, parameter_name, k + TIMED_POINT_COUNT - 1)
            cycle = solve_cycle(earlier, cycle_request(accuracy), neighbour, parameter_name, workspace)
            neighbour = require_cycle(cycle).start_for_next_rod
        neighbours[parameter_name] = neighbour
    solved = solve_cycle(rod, cycle_request(accuracy), parameter_name=SWEPT_PARAMETERS[0])
    return SweptRod(rod, MeshConvergedCycle.converged_from_orbit(orbit_of(solved)), neighbours, workspace)


def rod_earlier_in_sweep(rod: Rod, parameter_name: str, step_count: int) -> Rod:
    """Rod of the sweep along `parameter_name` that is `step_count` points before the rod `rod`, at a larger
    value."""
    return replace(rod, **{parameter_name: getattr(rod, parameter_name) * PARAMETER_STEP_RATIO**step_count})


def solve_timed_points(parameter_name: str, accuracy: float, rod: SweptRod) -> CycleOutcome:
    """The cycle of the last timed point of a sweep along `parameter_name`; every point is solved from the
    cycle of its neighbour. accuracy: relative accuracy. Raises ArithmeticError if a point has no stable
    cycle."""
    start = rod.start_cycle_by_parameter[parameter_name]
    for k in range(TIMED_POINT_COUNT - 1, -1, -1):
        point = rod_earlier_in_sweep(rod.rod, parameter_name, k)
        cycle = require_cycle(
            solve_cycle(point, cycle_request(accuracy), start, parameter_name, rod.workspace)
        )
        start = cycle.start_for_next_rod
    return cycle


def solve_without_neighbour(start_kind: str, accuracy: float, rod: SweptRod) -> CycleOutcome:
    """The cycle of a rod to a relative accuracy, not started from the cycle of a neighbouring rod; raises
    ArithmeticError if no stable cycle is found. start_kind: value of the option `start`."""
    request = replace(cycle_request(accuracy), start=start_kind)
    return require_cycle(solve_cycle(rod.rod, request, workspace=rod.workspace))


def require_cycle(cycle: CycleOutcome) -> CycleOutcome:
    """The argument `cycle`; raises ArithmeticError if no stable cycle was found."""
    if cycle.status != CycleStatus.cycle:
        raise ArithmeticError(f"no cycle: {cycle.status.name} {cycle.message}")
    return cycle


def cycle_contenders(accuracy: float) -> list[TimedMethod]:
    """Contenders that solve the cycle of a `SweptRod` to an accuracy: one for each of SWEPT_PARAMETERS, which
    starts from a neighbour's cycle, and one for each of COLD_STARTS."""
    setting = f"{accuracy:.0e}"
    with_neighbour = [
        TimedMethod(
            SWEEP_PREFIX + parameter_name,
            setting,
            SWEEP_PREFIX,
            partial(solve_timed_points, parameter_name, accuracy),
        )
        for parameter_name in SWEPT_PARAMETERS
    ]
    cold = {name: partial(solve_without_neighbour, start, accuracy) for name, start in COLD_STARTS.items()}
    return with_neighbour + [
        TimedMethod(COLD_PREFIX + name, setting, COLD_PREFIX, run) for name, run in cold.items()
    ]


def measure_sweep_points(points: Sequence[Rod], round_count: int) -> list[Measurement]:
    """Measurements of all `cycle_contenders` on all rods `points`, in `round_count` timed rounds."""
    rods = [swept_rod(point, ACCURACY) for point in points]
    cases = [
        CaseWithErrorMeasure(rod_label(rod.rod), rod, partial(cycle_measurement_fields, rod.reference_cycle))
        for rod in rods
    ]
    return measure_cases(cases, cycle_contenders(ACCURACY), round_count)


def cycle_measurement_fields(exact: MeshConvergedCycle, cycle: CycleOutcome) -> dict[str, Any]:
    """Fields of `Measurement` for a cycle: errors, error estimate, and, if the cycle has an orbit, mesh and
    number of Floquet multipliers. exact: reference cycle."""
    errors = exact.errors_of(cycle.measures.period, cycle.measures.tip_y_max)
    values = errors | {"order": float(cycle.order) if cycle.elements == 1 else nan}
    values["estimate"] = cycle.errors.largest_weighted_error
    if cycle.start_for_next_rod is not None:
        orbit = orbit_of(cycle)
        values["multipliers"] = len(Linearisation(orbit, NewtonWorkspace()).multipliers())
        values["order"] = float(sum(orbit.form.mesh.orders))
        values |= {"intervals": orbit.interval_count, "stages": orbit.stage_count}
    return {"error": max(errors.values()), "extra_columns": values}


def sweep_introduction() -> str:
    """Description of `sweep_table` for the report."""
    return (
        f"Cycles solved as points of a sweep: all multipliers included, accuracy {ACCURACY:.0e}, steps of "
        f"{PARAMETER_STEP_RATIO - 1:.0%} between neighbours. The time is the mean of {TIMED_POINT_COUNT} "
        "points up to the rod, with the finer meshes that give the errors. It includes the straight rod's "
        "spectrum, the choice of the mesh, the verdict, and the error estimate, which is the larger of the "
        "estimates for the period and for the extrema. Errors of the period and of the largest tip y are "
        f"relative to a solution on meshes with errors of {REFERENCE_ACCURACY:.0e}. Multipliers above "
        "rounding error are counted. The order is summed over the elements; the intervals in time cover half "
        "a period if the cycle is symmetric."
    )


def milliseconds_per_point(m: Measurement) -> float:
    """Time of one point in milliseconds; nan for a failed point."""
    points = TIMED_POINT_COUNT if m.method.startswith(SWEEP_PREFIX) else 1
    return nan if m.failure else 1e3 * m.seconds / points


def sweep_table(measurements: Sequence[Measurement]) -> str:
    """Table of the cost of a point: one line for each rod and start, and medians over the rods."""
    lines = [
        {"rod": m.case, "way": m.method, "ms": milliseconds_per_point(m), "failure": m.failure}
        | FAILED_POINT_CELLS
        | m.extra_columns
        for m in measurements
    ]
    medians = []
    for (method_name,), measured in grouped_by_fields(measurements, "method").items():
        ms = nan_median(map(milliseconds_per_point, measured))
        numbers = {
            name: nan_median(m.extra_columns.get(name, nan) for m in measured) for name in FAILED_POINT_CELLS
        }
        medians.append({"rod": "median", "way": method_name, "ms": ms, "failure": ""} | numbers)
    return markdown_table(
        "F, k1, k2, gamma3, gamma1 | start | ms | error of period | error of amplitude | estimate | "
        "multipliers | order | intervals | stages",
        "{rod} | {way} | {failure}{ms:.1f} | {period_error:.0e} | {amplitude_error:.0e} | {estimate:.0e} | "
        "{multipliers:.0f} | {order:.0f} | {intervals:.0f} | {stages:.0f}",
        lines + medians,
    )
