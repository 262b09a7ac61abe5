"""Work of all ranks before the result file is created: variables without points, data of all points."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import click

from ..config.schema import Config
from ..results.file.creation import Plan
from ..solve.backend.availability import require_solvers
from ..sweep.points.flutter_forces import FlutterForces, flutter_of_rod
from ..sweep.points.grid import flutter_rods
from ..sweep.stop import StopRequest
from ..sweep.team import Team
from ..tasks.protocol import Task


@dataclass(slots=True)
class _SharedWork:
    """Work divided among the ranks, which ends early when a rank receives a stop signal."""

    team: Team
    stop: StopRequest
    skipped: bool = False
    """Whether this rank has left out an item."""

    def in_order(self, items: Sequence[Any], work: Callable[[Any], Any]) -> list[Any]:
        """Results for all items, in order, on every rank; None for an omitted item."""
        return self.team.in_order(items, lambda item: self._unless_stopped(work, item))

    def _unless_stopped(self, work: Callable[[Any], Any], item: Any) -> Any:
        self.skipped = self.skipped or bool(self.stop)
        return None if self.skipped else work(item)

    @property
    def stopped(self) -> bool:
        """Whether any rank has left out an item; all ranks ask together."""
        return any(self.team.exchange(self.skipped))


def planned_beforehand(plan: Plan, task: Task, team: Team, stop: StopRequest) -> Plan | None:
    """The plan with constants computed by all ranks together; None if a stop signal came first."""
    shared = _SharedWork(team, stop)
    found = task.constants(shared.in_order)
    return None if shared.stopped else replace(plan, constants=lambda: found)


def flutter_beforehand(config: Config, team: Team, stop: StopRequest) -> FlutterForces | None:
    """Flutter forces of rods with a relative load, searched by all ranks together; None after a stop."""
    rods = team.on_first(lambda: flutter_rods(config))
    if not all(rod.standard for rod in rods):  # PETSc must start on all ranks together
        team.require_on_all_ranks(require_solvers)
    shared = _SharedWork(team, stop)
    found = shared.in_order(rods, flutter_of_rod)
    return None if shared.stopped else dict(zip(rods, found, strict=True))


def say_stopped(team: Team, stop: StopRequest) -> None:
    """Prints, on the first rank, that a stop came before the file was created; all ranks call together."""
    signal = max(team.exchange(stop.name))
    if team.first:
        click.echo(f"stopped by {signal}; no point is computed yet, the same command starts again")
