"""Computations shared by all ranks before the result file exists: flutter forces, and variables that do not
depend on points."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import click

from ..config.base_config import Config
from ..results.file.creation import FilePlan
from ..solve.backend.availability import require_solvers, start_solvers
from ..sweep.points.flutter_forces import FlutterForceByRod, flutter_force_of_rod
from ..sweep.points.points_from_config import rods_for_flutter_forces
from ..sweep.ranks import Ranks
from ..sweep.stop import StopRequest
from ..tasks.protocol import Task


@dataclass(slots=True)
class _ComputationsAmongRanks:
    """Computations divided among the ranks of `ranks`. Each rank omits its remaining items after a stop
    signal, recorded in `stop`."""

    ranks: Ranks
    stop: StopRequest
    has_skipped_items: bool = False
    """Whether this rank has omitted an item after a stop signal."""

    def gather_in_order(self, items: Sequence[Any], work: Callable[[Any], Any]) -> list[Any]:
        """Results of `work` for all items, in order, on every rank; None for an omitted item."""
        return self.ranks.map_in_order(items, lambda item: self._run_unless_stopped(work, item))

    def _run_unless_stopped(self, work: Callable[[Any], Any], item: Any) -> Any:
        self.has_skipped_items = self.has_skipped_items or bool(self.stop)
        return None if self.has_skipped_items else work(item)

    @property
    def any_rank_stopped(self) -> bool:
        """Whether any rank has omitted an item. Collective: all ranks call together."""
        return any(self.ranks.gather_on_all_ranks(self.has_skipped_items))


def plan_with_variables_from_config(
    plan: FilePlan, task: Task, ranks: Ranks, stop: StopRequest
) -> FilePlan | None:
    """The plan of a result file, with the variables that do not depend on points, computed by all ranks
    together.

    None if a stop signal came before the computation ended.
    """
    computations = _ComputationsAmongRanks(ranks, stop)
    variables = task.variables_from_config(computations.gather_in_order)
    return None if computations.any_rank_stopped else replace(plan, variables_from_config=lambda: variables)


def shared_flutter_forces(config: Config, ranks: Ranks, stop: StopRequest) -> FlutterForceByRod | None:
    """Flutter force of every rod whose load is relative to flutter, by rod, computed by all ranks together.

    None if a stop signal came before the computation ended.
    """
    rods = ranks.call_on_first_rank(lambda: rods_for_flutter_forces(config))
    if not all(rod.is_uniform_and_linear for rod in rods):
        # A rank without a rod must start PETSc with the others.
        ranks.require_on_all_ranks(require_solvers)
        ranks.require_on_all_ranks(start_solvers)
    computations = _ComputationsAmongRanks(ranks, stop)
    forces = computations.gather_in_order(rods, flutter_force_of_rod)
    return None if computations.any_rank_stopped else dict(zip(rods, forces, strict=True))


def report_stop(ranks: Ranks, stop: StopRequest) -> None:
    """Prints, on the first rank, that a signal stopped the run before the result file was created.

    Collective: all ranks call together.
    """
    signal_name = max(ranks.gather_on_all_ranks(stop.name))
    if ranks.is_first:
        click.echo(f"stopped by {signal_name}; no point is computed yet, the same command starts again")
