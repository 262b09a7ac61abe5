"""Time integration of a cycle: the piece of motion, families of integrators, and PETSc's integrator.

All integrators use the same compiled rate and exact Jacobian of a beam. `tolerance` is the error of each
component of z, in units of the component's largest value.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import NamedTuple

from ...arrays import Array
from ...discretization.beam import Beam
from ...solve.motion.integrator import RunEnding, Trajectory, integrator
from ...solve.motion.time_scheme import TimeScheme
from ..study import Contender

TIGHT_TOLERANCE = 3e-7
"""Tolerance below which Newton's default convergence test would limit the accuracy of ARKIMEX 5."""
TIGHT_NEWTON_TOLERANCE = 0.03
"""Convergence tolerance of Newton's method, as a fraction of the integrator's tolerance, if the latter is
below TIGHT_TOLERANCE."""


class IntegrationTask(NamedTuple):
    """Task of an integrator: a beam, its state z at the start, shape (unknowns,), and a duration in tau2."""

    beam: Beam
    z: Array
    duration: float


Integration = Callable[[float, IntegrationTask], Trajectory]
"""Runs an integrator, (tolerance, leg) -> trajectory; raises ArithmeticError if the integration fails."""


@dataclass(frozen=True, slots=True)
class IntegratorFamily:
    """An integrator and the tolerances, from the loosest, at which it is run.

    waiting: tolerances, from the loosest, for waiting until a cycle is reached; empty to leave waiting out.
    """

    name: str
    integrate: Integration
    tolerances: tuple[float, ...]
    waiting: tuple[float, ...] = ()

    def followers(self) -> list[Contender]:
        """Contenders for following a cycle."""
        return [self._at(tolerance) for tolerance in self.tolerances]

    def waiters(self) -> list[Contender]:
        """Contenders for waiting until a cycle is reached."""
        return [self._at(tolerance) for tolerance in self.waiting]

    def _at(self, tolerance: float) -> Contender:
        run = partial(self.integrate, tolerance)
        return Contender(self.name, f"{tolerance:.0e}", self.name.split()[0], run)


def by_petsc(family: str, variant: str, tolerance: float, leg: IntegrationTask) -> Trajectory:
    """PETSc TS as in the task limit_cycle, with a choice of scheme."""
    newton = TimeScheme().newton if tolerance > TIGHT_TOLERANCE else TIGHT_NEWTON_TOLERANCE
    scheme = TimeScheme(family, variant, tolerance, newton, prefix="bench_")
    run = integrator(leg.beam.mesh, scheme).run(leg.beam, leg.z, leg.duration)
    if run.ending != RunEnding.reached:
        raise ArithmeticError(f"{family} {variant} at {tolerance:g}: {run.ending.name} {run.message}")
    return run


WAITING_TOLERANCES = (1e-6, 3e-7, 1e-7, 3e-8, 1e-8, 3e-9, 1e-9)
"""Tolerances for waiting until a cycle is reached."""
DEFAULT = IntegratorFamily(
    "ARKIMEX 5 (default)",
    partial(by_petsc, "arkimex", "5"),
    (1e-5, 5e-6, 2e-6, 1e-6, 3e-7, 1e-7, 1e-8),
    WAITING_TOLERANCES,
)
