"""The task limit_cycle: the limit cycle of the nonlinear rod at every point, or the return of the rod to
rest."""

from dataclasses import dataclass, replace
from math import isfinite
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

import numpy as np

from ..arrays import COMPLEX_NAN
from ..config.task.limit_cycle import LimitCycleConfig
from ..discretization.elements.elements import Elements
from ..discretization.elements.quadrature import lobatto_points
from ..model.parameters import Range
from ..results.layouts.limit_cycle import (
    CYCLE_VARIABLES,
    ENERGY_VARIABLES,
    PERIOD_TAU1_VARIABLE,
    SHAPE_VARIABLES,
    STORED_MULTIPLIER_COUNT,
    TIP_VARIABLES,
    TRANSIENT_VARIABLES,
)
from ..results.layouts.variables import FilledVariable, Variable, outcome_values
from ..solve.backend.availability import require_solvers
from ..sweep.cost_estimate import CostEstimate
from ..sweep.cycle_cost import cycles_cost, marched_cycles_cost
from ..sweep.finest_initial_mesh import finest_initial_mesh
from ..sweep.points.chains import Chains, SweepChains
from ..sweep.points.points_from_config import require_in_range
from ..wording import counted
from .check_rows import (
    arms_line,
    point_count_text,
    point_count_text_with_clause,
    stretch_shear_and_drag_rows,
    varying_arm_and_law_rows,
)
from .hopf.hopf_on_lines import HopfSearchLine, filled_hopf_point_variables, hopf_search_lines_of_points
from .protocol import CheckRow, MapInOrder, NamedArrays, Solver, Task, map_on_one_rank

if TYPE_CHECKING:
    from ..solve.cycle.limit_cycle import CycleOutcome, CycleRequest

NON_SOLVER_OPTIONS = ("method", "along", "direction", "time")
"""Options of the task that concern the sweep or the file; all other options are passed to the solver of a
cycle."""
MULTIPLIER_FIELD_BY_VARIABLE = {f"multiplier_{part}": f"multipliers_{part}" for part in ("real", "imag")}
"""Field of `CycleOutcome` by name of the variable, where the two names differ."""
K2_VALUES_WITH_TAU1 = Range(isfinite, "a finite number")
"""Values of k2 for which the time scale tau1 = gamma3/k2 is positive."""
GAMMA3_VALUES_WITH_TAU1 = Range(lambda value: value > 0, "a number above 0")
"""Values of gamma3 for which the time scale tau1 = gamma3/k2 is positive."""


@dataclass(frozen=True, slots=True)
class LimitCycleTask(Task):
    """The task limit_cycle: a limit cycle, or a status without cycle, at every point."""

    config: LimitCycleConfig
    """The config, with the section `limit_cycle`."""

    def __post_init__(self) -> None:
        if self.config.limit_cycle.time == "tau1":
            reason = ", because tau1 = gamma3/k2 is the unit of time that limit_cycle.time asks for"
            values = self.points.parameter_values_of_rods
            require_in_range(K2_VALUES_WITH_TAU1, "k2", values["k2"], "", reason)
            require_in_range(GAMMA3_VALUES_WITH_TAU1, "gamma3", values["gamma3"], "", reason)

    @property
    def chains(self) -> Chains | None:
        """Chains of points, each started from the cycle of the previous point; None without chains."""
        options = self.config.limit_cycle
        if options.start != "neighbour":
            return None
        axis = self.points.varied_parameter_by_axis.index(self.config.chain_parameter)
        return Chains(self.points.shape, axis, options.direction == "up")

    def coordinates(self) -> dict[str, np.ndarray]:
        """Times of samples, shapes and transients, and material coordinates of shapes, (n,) each, by name of
        the dimension."""
        options = self.config.limit_cycle
        extents = {"sample": options.samples, "shape": options.shapes}
        times: NamedArrays = {name: np.arange(count) / count for name, count in extents.items() if count}
        if options.transient:
            times["transient"] = np.linspace(0.0, 1.0, options.transient)
        return times | ({"u": lobatto_points(options.nodes)} if options.shapes else {})

    def variables_from_config(self, in_order: MapInOrder = map_on_one_rank) -> tuple[FilledVariable, ...]:
        """Hopf points of the straight rods, along the lines of points that differ in one parameter. in_order:
        function that applies a function to each element of a sequence, on all ranks, and returns the results
        in order."""
        lines = hopf_search_lines_of_points(self.points)
        if lines:
            require_solvers()
        hopf_points = in_order(lines, HopfSearchLine.hopf_points)
        return filled_hopf_point_variables(self.points.names, lines, hopf_points)

    def headline_of_check(self) -> str:
        options = self.config.limit_cycle
        chains = self.chains
        start_text = f"the leading mode with tip deflection {options.amplitude:g} L"
        if options.start == "hopf":
            start_text = "the nearest Hopf point below its force"
        if chains is None:
            return point_count_text_with_clause(self.points, f"started from {start_text}")
        chains_text = f"{counted(chains.count, 'chain')} of {chains.points_per_chain}"
        return (
            f"{point_count_text(self.points)} in {chains_text}, {options.direction} in "
            f"{self.config.chain_parameter}: each starts from its neighbour's cycle; the first point, and a "
            f"point whose neighbour has no cycle, starts from {start_text}; at most "
            f"{counted(chains.count, 'rank')} can share the work"
        )

    def arms_line(self) -> str:
        return arms_line(self.config, self.points.parameter_values_of_rods, self._finest_initial_mesh)

    def _finest_initial_mesh(self) -> Elements | None:
        """The finest of the initial meshes of all points: meshes of motions in time or, with start: hopf, of
        branches from Hopf points. None if no point has a mesh."""
        from ..solve.cycle.transient.motion_mesh import (
            accuracy_of_motion_mesh,
            coarse_mesh_for_branch_to_cycle,
            motion_mesh,
        )

        options = self.config.limit_cycle
        if options.start == "hopf":
            return finest_initial_mesh(self.points, coarse_mesh_for_branch_to_cycle)
        accuracy = accuracy_of_motion_mesh(options.transient > 0)
        if options.method == "integration":
            accuracy = self.config.accuracy
        return finest_initial_mesh(self.points, lambda rod: motion_mesh(rod, accuracy))

    def rows_of_check(self) -> list[CheckRow]:
        """Rows of the table of `rodsweep check`: modelled and neglected effects, and stored variables."""
        options = self.config.limit_cycle
        gamma1 = np.unique(self.points.parameter_values_of_rods["gamma1"])[:5]
        is_integrated = options.method == "integration"
        transient_row = "tip from the start to the cycle", False, f"limit_cycle.method: {options.method}"
        if not is_integrated:
            transient_row = self._row_on_stored_values(transient_row[0], "transient", TRANSIENT_VARIABLES)
        tip_variables = TIP_VARIABLES + ENERGY_VARIABLES
        return [
            *stretch_shear_and_drag_rows(self.points.parameter_values_of_rods),
            *varying_arm_and_law_rows(self.config, self.points.parameter_values_of_rods),
            ("axial drag", True, f"gamma1 = {', '.join(f'{value:g}' for value in gamma1)}"),
            ("nonlinear motion", True, "task: limit_cycle; in the plane, geometrically exact"),
            ("energy budget", True, "means and fluctuations over a cycle"),
            ("Floquet multipliers", not is_integrated, f"limit_cycle.method: {options.method}"),
            self._row_on_stored_values("tip and energy over a cycle", "samples", tip_variables),
            self._row_on_stored_values("shapes over a cycle", "shapes", SHAPE_VARIABLES),
            transient_row,
            ("period in units of tau1", options.time == "tau1", f"limit_cycle.time: {options.time}"),
            ("gravity, inertia, motion out of the plane", False, "not part of the overdamped problem"),
        ]

    def _row_on_stored_values(
        self, description: str, option: str, variables: tuple[Variable, ...]
    ) -> CheckRow:
        """Row of the table of `rodsweep check` on variables that are stored only on request, with number and
        size of the stored values. option: name of the option of limit_cycle with the number of values per
        point."""
        options = self.config.limit_cycle
        sample_count: int = getattr(options, option)
        if not sample_count:
            return description, False, f"limit_cycle.{option} stores them"
        total = self.points.count * sample_count
        value_count = total * len(variables) * (options.nodes if option == "shapes" else 1)
        nodes_text = f" on {options.nodes} nodes" if option == "shapes" else ""
        size_text = f"{total} in total: {8e-6 * value_count:.3g} MB"
        return description, True, f"{sample_count} per point{nodes_text}, {size_text}"

    def cost(self) -> CostEstimate:
        if self.config.limit_cycle.method == "integration":
            return marched_cycles_cost(self.points.count, self.config.accuracy)
        chain_or_point_count = self.chains.count if self.chains else self.points.count
        return cycles_cost(self.points, chain_or_point_count)

    def solver(self) -> Solver:
        from ..solve.cycle.limit_cycle import CycleStart, CycleStatus, solve_cycle
        from ..solve.cycle.rod_with_known_cycle import warm_up
        from ..solve.orbit.matrix.workspace import NewtonWorkspace

        request = self.cycle_request()
        chains = self.chains
        chain_parameter = self.config.chain_parameter if chains else None
        workspace = NewtonWorkspace()

        def solve(index: int, start: "CycleStart | None" = None) -> "CycleOutcome":
            return solve_cycle(self.points.rod(index), request, start, chain_parameter, workspace)

        def solve_from(index: int, start: "CycleStart | None") -> "tuple[CycleOutcome, CycleStart | None]":
            cycle = solve(index, start)
            return cycle, cycle.start_for_next_rod if cycle.status == CycleStatus.cycle else None

        by_collocation = Solver(
            possible_statuses=tuple(CycleStatus),
            warm_up=warm_up,
            solve=solve,
            file_values_of_outcome=lambda index, cycle: self.cycle_values(
                self.points.parameter_values_of_point(index), cycle
            ),
            sweep_chains=SweepChains(chains, solve_from, CycleStart.from_arrays) if chains else None,
        )
        if self.config.limit_cycle.method == "collocation":
            return by_collocation
        from ..solve.cycle.by_integration import solve_by_integration
        from ..solve.cycle.status import IntegratedCycleStatus

        return replace(
            by_collocation,
            possible_statuses=tuple(IntegratedCycleStatus),
            solve=lambda index: solve_by_integration(self.points.rod(index), request),
        )

    def cycle_request(self) -> "CycleRequest":
        """The settings with which `solve_cycle` solves the cycle at every point."""
        from ..solve.cycle.limit_cycle import CycleRequest

        options = self.config.limit_cycle.model_dump(exclude=set(NON_SOLVER_OPTIONS))
        return CycleRequest(accuracy=self.config.accuracy, **options)

    def cycle_values(self, point: dict[str, float], cycle: "CycleOutcome") -> dict[str, Any]:
        """Variables of the file for the cycle of one point; point: parameters by name."""
        options = self.config.limit_cycle
        unknown = np.full(STORED_MULTIPLIER_COUNT, COMPLEX_NAN)
        multipliers = unknown if cycle.multipliers is None else cycle.multipliers
        stored_multipliers = SimpleNamespace(multipliers=multipliers)
        sources = stored_multipliers, cycle.errors, cycle.measures, cycle
        values = outcome_values(CYCLE_VARIABLES, *sources, names=MULTIPLIER_FIELD_BY_VARIABLE)
        if options.time == "tau1":  # t/tau1 = (t/tau2) k2/gamma3
            values[PERIOD_TAU1_VARIABLE.name] = cycle.measures.period * point["k2"] / point["gamma3"]
        if options.samples:
            values |= _values_by_variable(TIP_VARIABLES, cycle.tip)
            values |= _values_by_variable(ENERGY_VARIABLES, cycle.energy_and_powers)
        if options.shapes:
            values |= _values_by_variable(SHAPE_VARIABLES, cycle.shape)
        if options.transient:
            values |= _values_by_variable(TRANSIENT_VARIABLES, cycle.transient_tip_path)
        return values


def _values_by_variable(variables: tuple[Variable, ...], arrays: np.ndarray | None) -> dict[str, Any]:
    """Values of variables by name, from arrays in the order of the variables; NaN for all variables if
    `arrays` is None."""
    names = [variable.name for variable in variables]
    return dict.fromkeys(names, np.nan) if arrays is None else dict(zip(names, arrays, strict=True))
