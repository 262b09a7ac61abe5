"""What follows a cycle in time: a leg of the motion, families of integrators, and rodsweep's own by PETSc.

All see the same compiled rate and exact Jacobian of a beam, and one `tolerance`: of each component of z, in
units of its largest.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import NamedTuple

from ...arrays import Array
from ...discretization.beam import Beam
from ...solve.motion.integrator import Ending, Trajectory, integrator
from ...solve.motion.time_scheme import TimeScheme
from ..study import Contender

TIGHT = 3e-7
"""Tolerance below which Newton's errors would show in those of ARKIMEX 5 with the default's test."""
TIGHT_NEWTON = 0.03


class Leg(NamedTuple):
    """What an integrator is run on: a beam from its state z, shape (unknowns,), for a duration in tau2."""

    beam: Beam
    z: Array
    duration: float


Integration = Callable[[float, Leg], Trajectory]
"""(tolerance, leg) to the run; raises ArithmeticError where the integration fails."""


@dataclass(frozen=True, slots=True)
class Family:
    """An integrator and the tolerances, from the loosest, at which it is worth running.

    waiting: those, from the loosest, at which one may wait for a cycle; none where one would not.
    """

    name: str
    integrate: Integration
    tolerances: tuple[float, ...]
    waiting: tuple[float, ...] = ()

    def followers(self) -> list[Contender]:
        """What follows a cycle."""
        return [self._at(tolerance) for tolerance in self.tolerances]

    def waiters(self) -> list[Contender]:
        """What waits for a cycle."""
        return [self._at(tolerance) for tolerance in self.waiting]

    def _at(self, tolerance: float) -> Contender:
        run = partial(self.integrate, tolerance)
        return Contender(self.name, f"{tolerance:.0e}", self.name.split()[0], run)


def by_petsc(family: str, variant: str, tolerance: float, leg: Leg) -> Trajectory:
    """PETSc TS, as the task limit_cycle uses it, with one of its schemes."""
    newton = TimeScheme().newton if tolerance > TIGHT else TIGHT_NEWTON
    scheme = TimeScheme(family, variant, tolerance, newton, prefix="bench_")
    run = integrator(leg.beam.mesh, scheme).run(leg.beam, leg.z, leg.duration)
    if run.ending != Ending.reached:
        raise ArithmeticError(f"{family} {variant} at {tolerance:g}: {run.ending.name} {run.message}")
    return run


CAREFUL = (1e-6, 3e-7, 1e-7, 3e-8, 1e-8, 3e-9, 1e-9)
"""Tolerances at which one may wait for a cycle."""
DEFAULT = Family(
    "ARKIMEX 5 (default)",
    partial(by_petsc, "arkimex", "5"),
    (1e-5, 5e-6, 2e-6, 1e-6, 3e-7, 1e-7, 1e-8),
    CAREFUL,
)
