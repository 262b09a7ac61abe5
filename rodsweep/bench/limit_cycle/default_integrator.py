"""The default time integrator in the limit-cycle benchmark; the task and the tolerances of all integrators.

Integrators that rodsweep does not use are in `benchmarks/limit_cycle/integrators.py`. All integrators use the
same compiled function for dz/dt and the same exact Jacobian. A tolerance is the allowed error of each
component of the state z, divided by the largest value of this component.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import NamedTuple

from ...arrays import Array
from ...discretization.explicit_system import ExplicitSystem
from ...solve.motion.integrator import EndReason, Trajectory, integrator
from ...solve.motion.time_scheme import TimeScheme
from ..study import TimedMethod

MAX_TOLERANCE_WITH_TIGHT_NEWTON = 3e-7
"""At integrator tolerances up to this number, the tolerance of Newton's method is
TIGHT_NEWTON_TOLERANCE_RATIO times the integrator tolerance; the larger default ratio would limit the accuracy
of ARKIMEX 5."""
TIGHT_NEWTON_TOLERANCE_RATIO = 0.03
"""Convergence tolerance of Newton's method divided by the tolerance of the integrator, at integrator
tolerances up to MAX_TOLERANCE_WITH_TIGHT_NEWTON."""


class IntegrationTask(NamedTuple):
    """Task of an integrator. system: rod on its mesh. initial_state: initial state, (unknowns,). duration:
    time in tau2."""

    system: ExplicitSystem
    initial_state: Array
    duration: float


IntegrateFunction = Callable[[float, IntegrationTask], Trajectory]
"""Integrator: a function (tolerance, task) -> trajectory that raises ArithmeticError if the integration
fails."""


@dataclass(frozen=True, slots=True)
class IntegratorWithTolerances:
    """An integrator with its name in the tables, and its tolerances, from the loosest.

    integrate: the integrator. following_tolerances: tolerances of the runs that follow a cycle.
    settling_tolerances: tolerances of the runs until the motion is periodic; empty if the integrator has no
    such runs.
    """

    name: str
    integrate: IntegrateFunction
    following_tolerances: tuple[float, ...]
    settling_tolerances: tuple[float, ...] = ()

    def following_contenders(self) -> list[TimedMethod]:
        """Contenders of the race CYCLE_FOLLOWING_RACE_NAME, which follow a cycle in time: one for each of
        `following_tolerances`."""
        return [self._method_at_tolerance(tolerance) for tolerance in self.following_tolerances]

    def settling_contenders(self) -> list[TimedMethod]:
        """Contenders of the race SETTLING_TO_CYCLE_RACE_NAME, which integrate until the motion is periodic:
        one for each of `settling_tolerances`."""
        return [self._method_at_tolerance(tolerance) for tolerance in self.settling_tolerances]

    def _method_at_tolerance(self, tolerance: float) -> TimedMethod:
        run = partial(self.integrate, tolerance)
        return TimedMethod(self.name, f"{tolerance:.0e}", self.name.split()[0], run)


def petsc_trajectory(ts_type: str, scheme_name: str, tolerance: float, task: IntegrationTask) -> Trajectory:
    """Trajectory of `task`, integrated by a scheme of PETSc TS as in the task `limit_cycle`; raises
    ArithmeticError if the integration fails. ts_type, scheme_name: type of TS and name of the scheme, such as
    "arkimex" and "5". tolerance: see the module docstring."""
    newton_ratio = (
        TimeScheme().newton_tolerance_ratio
        if tolerance > MAX_TOLERANCE_WITH_TIGHT_NEWTON
        else TIGHT_NEWTON_TOLERANCE_RATIO
    )
    scheme = TimeScheme(ts_type, scheme_name, tolerance, newton_ratio, options_prefix="bench_")
    result = integrator(task.system.mesh, scheme).run(task.system, task.initial_state, task.duration)
    if result.end_reason != EndReason.reached:
        raise ArithmeticError(
            f"{ts_type} {scheme_name} at {tolerance:g}: {result.end_reason.name} {result.message}"
        )
    return result


SETTLING_INTEGRATOR_TOLERANCES = (1e-6, 3e-7, 1e-7, 3e-8, 1e-8, 3e-9, 1e-9)
"""Tolerances at which integrators run until the motion is periodic, from the loosest."""
DEFAULT_INTEGRATOR = IntegratorWithTolerances(
    "ARKIMEX 5 (default)",
    partial(petsc_trajectory, "arkimex", "5"),
    (1e-5, 5e-6, 2e-6, 1e-6, 3e-7, 1e-7, 1e-8),
    SETTLING_INTEGRATOR_TOLERANCES,
)
"""The integrator that rodsweep uses by default."""
