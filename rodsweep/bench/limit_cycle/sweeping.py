"""Cost of a point of a sweep: the cycle of a rod started from a neighbour's cycle, and from a cold start.

A point includes all work of the task limit_cycle: mesh, Newton's method, all multipliers, the verdict and the
error estimate. Errors are measured against the same cycle on meshes with errors of 1e-11.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from math import nan
from typing import Any

from ...model.material.build import Build
from ...model.parameters import NONLINEAR_PARAMETERS
from ...model.rod import Rod
from ...solve.cycle.accuracy.refinement import refined_at_period
from ...solve.cycle.limit_cycle import Cycle, CycleStatus, solve_cycle
from ...solve.cycle.neighbour import Neighbour
from ...solve.orbit.matrix.linearisation import Linearisation
from ...solve.orbit.matrix.workspace import NewtonWorkspace
from ...solve.orbit.measures import CyclePath
from ...solve.orbit.newton import newton
from ...solve.orbit.orbit import Orbit
from ...solve.orbit.orbit_mesh import mesh_of
from ..study import Contender, JudgedCase, Measurement, grouped, middle, table, tournament
from .tracking import REFERENCE_NEWTON_TOLERANCE, cycle_request, orbit_of

RODS = (
    Rod(F=50.0, k1=1e4, k2=1e2, gamma3=1e-2, gamma1=1.0),
    Rod(F=50.0, k1=1e4, k2=1e2, gamma3=1e-2, gamma1=0.5),
    Rod(F=30.0, k1=1e4, k2=1e2, gamma3=1e-2, gamma1=1.0),
    Rod(F=100.0, k1=1e4, k2=1e2, gamma3=1e-2, gamma1=1.0),
    Rod(F=40.0, k1=1e4, k2=1e4, gamma3=1e-4, gamma1=1.0),
    Rod(F=60.0, k1=200.0, k2=1e4, gamma3=1e-4, gamma1=1.0),
    Rod(F=100.0, k1=200.0, k2=1e4, gamma3=1e-4, gamma1=1.0),
    Rod(F=20.0, k1=1e4, k2=1e2, gamma3=1e-2, gamma1=1.0, taper=0.5),
    Rod(F=50.0, k1=1e4, k2=1e2, gamma3=1e-2, gamma1=1.0, build=Build("neo_hookean", "swelling")),
)
"""Rods with cycles near and far from Hopf points, stiff rods, and a rod shortened to half by its force;
a cone as far from its Hopf point as the first rod, and the first rod made of rubber."""
QUICK_RODS = (RODS[2],)
SWEPT = NONLINEAR_PARAMETERS[:2]
STEP = 1.01
"""Ratio of the parameter from one point of the sweep to the next."""
WARM_UP_POINTS = 6
"""Number of points solved before the timed points, so that the mesh is already chosen."""
TIMED_POINTS = 22
"""Number of timed points: one calibration of the mesh errors, and all points served by it."""
ACCURACY = 1e-7
REFERENCE_ACCURACY = 1e-11
SWEEP = "sweep over "
COLD_START = "cold, "
COLD_STARTS = {"leading mode": "mode", "Hopf point": "hopf"}
"""Starts without a neighbour, by their values of the option `start`."""
FAILED_COLUMNS = dict.fromkeys(
    ("period_error", "amplitude_error", "estimate", "multipliers", "order", "intervals", "stages"), nan
)
"""Columns of a failed point."""


@dataclass(frozen=True, eq=False)
class ExactCycle:
    """A cycle on a mesh with errors of REFERENCE_ACCURACY; period in tau2, largest y of the tip in L."""

    orbit: Orbit
    period: float
    tip_y_max: float

    @classmethod
    def near(cls, orbit: Orbit) -> "ExactCycle":
        """The exact cycle of the orbit's rod."""
        found = refined_at_period(orbit, REFERENCE_ACCURACY, NewtonWorkspace())
        return cls(found.orbit, found.measures.period, found.measures.tip_y_max)

    def at(self, F: float) -> "ExactCycle":
        """The exact cycle of the rod at a nearby force."""
        form = self.orbit.form
        near = replace(self.orbit, form=replace(form, rod=replace(form.rod, F=F)))
        orbit = newton(near, REFERENCE_NEWTON_TOLERANCE, NewtonWorkspace()).orbit
        return ExactCycle(orbit, orbit.period, CyclePath(orbit).extrema["tip_y_max"])

    def errors_of(self, period: float, tip_y_max: float) -> dict[str, float]:
        """Relative errors by their names in the tables."""
        return {
            "period_error": abs(period / self.period - 1),
            "amplitude_error": abs(tip_y_max / self.tip_y_max - 1),
        }


@dataclass(frozen=True, eq=False)
class SweptRod:
    """A rod, its exact cycle, and the neighbour on each axis from which a stretch to the rod starts.

    workspace: buffers of Newton's matrices, shared by all points of a sweep.
    """

    point: Rod
    exact: ExactCycle
    neighbours: dict[str, Neighbour | None]
    workspace: NewtonWorkspace


def swept(point: Rod, accuracy: float) -> SweptRod:
    """The rod with its neighbours: points of downward sweeps that end at the rod."""
    neighbours: dict[str, Neighbour | None] = {}
    workspace = NewtonWorkspace()
    for axis in SWEPT:
        before: Neighbour | None = None
        for k in range(WARM_UP_POINTS, 0, -1):
            there = beyond(point, axis, k + TIMED_POINTS - 1)
            before = settled(solve_cycle(there, cycle_request(accuracy), before, axis, workspace)).neighbour
        neighbours[axis] = before
    here = solve_cycle(point, cycle_request(accuracy), along=SWEPT[0])
    return SweptRod(point, ExactCycle.near(orbit_of(here)), neighbours, workspace)


def beyond(point: Rod, axis: str, steps: int) -> Rod:
    """The point of the sweep `steps` before the given point."""
    return replace(point, **{axis: getattr(point, axis) * STEP**steps})


def from_neighbour(axis: str, accuracy: float, rod: SweptRod) -> Cycle:
    """Solves a stretch of a sweep over an axis; returns its last cycle."""
    start = rod.neighbours[axis]
    for k in range(TIMED_POINTS - 1, -1, -1):
        there = beyond(rod.point, axis, k)
        cycle = settled(solve_cycle(there, cycle_request(accuracy), start, axis, rod.workspace))
        start = cycle.neighbour
    return cycle


def from_cold(start: str, accuracy: float, rod: SweptRod) -> Cycle:
    """Solves the rod without a neighbour."""
    return settled(
        solve_cycle(rod.point, replace(cycle_request(accuracy), start=start), workspace=rod.workspace)
    )


def settled(cycle: Cycle) -> Cycle:
    """The cycle itself; raises ArithmeticError if the solve found none."""
    if cycle.status != CycleStatus.cycle:
        raise ArithmeticError(f"no cycle: {cycle.status.name} {cycle.message}")
    return cycle


def cycle_contenders(accuracy: float) -> list[Contender]:
    """All starts of a point, as contenders."""
    setting = f"{accuracy:.0e}"
    warm = [
        Contender(SWEEP + axis, setting, SWEEP, partial(from_neighbour, axis, accuracy)) for axis in SWEPT
    ]
    cold = [
        Contender(COLD_START + name, setting, COLD_START, partial(from_cold, start, accuracy))
        for name, start in COLD_STARTS.items()
    ]
    return warm + cold


def sweep_points(points: Sequence[Rod], rounds: int) -> list[Measurement]:
    """All starts of all points, timed in turn."""
    rods = [swept(point, ACCURACY) for point in points]
    entries = [JudgedCase(name_of(rod.point), rod, partial(judged_cycle, rod.exact)) for rod in rods]
    return tournament(entries, cycle_contenders(ACCURACY), rounds)


def name_of(point: Rod) -> str:
    """Label of a rod: its parameters in the order of the tables, then what distinguishes an arm."""
    further = [] if point.taper == 1 else [f"taper {point.taper:g}"]
    further += [] if point.build.standard else [point.build.law, point.build.section]
    values = (point.F, point.k1, point.k2, point.gamma3, point.gamma1)
    return ", ".join([*(f"{value:g}" for value in values), *further])


def judged_cycle(exact: ExactCycle, cycle: Cycle) -> dict[str, Any]:
    """Errors and error estimate of a cycle, its mesh, and the number of multipliers.

    Columns derived from the orbit are missing if the solve returns no orbit.
    """
    errors = exact.errors_of(cycle.measures.period, cycle.measures.tip_y_max)
    extra = errors | {"estimate": cycle.errors.largest, "order": float(cycle.elements * cycle.order)}
    if cycle.neighbour is not None:
        orbit = orbit_of(cycle)
        mesh = mesh_of(orbit)
        extra["multipliers"] = len(Linearisation(orbit, NewtonWorkspace()).multipliers())
        extra |= {"intervals": mesh.intervals, "stages": mesh.stages}
    return {"error": max(errors.values()), "extra": extra}


def sweep_introduction() -> str:
    """Description of the measurements for the report."""
    return (
        f"Cycles solved as points of a sweep: all multipliers included, accuracy {ACCURACY:.0e}, steps of "
        f"{STEP - 1:.0%} between neighbours. The time is the mean of {TIMED_POINTS} points up to the rod, "
        "with the finer meshes that calibrate errors. It includes the straight rod's spectrum, the choice of "
        "the mesh, the verdict, and the error estimate, which is the larger of the estimates for the period "
        "and for the extrema. Errors of the period and of the largest tip y are relative to a solution on "
        f"meshes with errors of {REFERENCE_ACCURACY:.0e}. Multipliers are counted above rounding. The order "
        "in space is that of one element; the intervals in time cover half a period if the cycle is "
        "symmetric."
    )


def milliseconds(m: Measurement) -> float:
    """Time of one point in milliseconds; nan for a failed point."""
    points = TIMED_POINTS if m.method.startswith(SWEEP) else 1
    return nan if m.failure else 1e3 * m.seconds / points


def sweep_table(measurements: Sequence[Measurement]) -> str:
    """Table with a line for each rod and start, and the medians over the rods."""
    lines = [
        {"rod": m.case, "way": m.method, "ms": milliseconds(m), "failure": m.failure}
        | FAILED_COLUMNS
        | m.extra
        for m in measurements
    ]
    medians = [
        {"rod": "median", "way": way, "ms": middle(map(milliseconds, own)), "failure": ""}
        | {name: middle(m.extra.get(name, nan) for m in own) for name in FAILED_COLUMNS}
        for (way,), own in grouped(measurements, "method").items()
    ]
    return table(
        "F, k1, k2, gamma3, gamma1 | start | ms | error of period | error of amplitude | estimate | "
        "multipliers | order | intervals | stages",
        "{rod} | {way} | {failure}{ms:.1f} | {period_error:.0e} | {amplitude_error:.0e} | {estimate:.0e} | "
        "{multipliers:.0f} | {order:.0f} | {intervals:.0f} | {stages:.0f}",
        lines + medians,
    )
