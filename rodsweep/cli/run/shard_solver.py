"""Solution of the points of a run, in work items shared among the ranks; every rank writes its results into a
journal. A work item is a point, a chain or a group of points."""

import socket
from collections.abc import Callable, Iterable
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from ...errors import EnvironmentIncomplete
from ...results.file.creation import FilePlan
from ...results.run.checkpoints import Checkpoints
from ...results.run.journal import Journal, journal_directory, kept_points_clause
from ...sweep.chunk_queue import ChunkQueue
from ...sweep.loop import PointIndexOrIndices, SweepCallbacks, sweep
from ...sweep.points.chains import ChainSolver
from ...sweep.points.groups import GroupResult, GroupSolver
from ...sweep.points.ranges import IndexRange, IndexSet, Shard, index_count
from ...sweep.progress import ProgressReporter, SilentProgress
from ...sweep.ranks import Ranks
from ...sweep.stop import StopRequest
from ...tasks.protocol import Solver
from ...tasks.running.job import Job
from ...tasks.running.unforeseen_exceptions import FailureReasons
from .run_end import ReportOfRank


@dataclass(frozen=True, kw_only=True)
class ShardSolver:
    """Solves the points of a shard of a job, and writes the results into journals next to the result file
    `output`.

    ranks: all ranks. solver: solver of the points. plan: plan of the result file. stop: stop request of this
    process.
    """

    ranks: Ranks
    job: Job
    solver: Solver
    plan: FilePlan
    shard: Shard
    output: Path
    stop: StopRequest
    quiet: bool
    """Whether to hide the progress."""
    point_text: Callable[[int], str]
    """Function from the flat index of a point to a text with the point's parameters."""

    def items_to_solve_and_point_count(self, missing: list[IndexRange]) -> tuple[list[IndexRange], int]:
        """Returns (ranges of the numbers of this shard's work items with missing points, number of missing
        points in these work items).

        missing: ranges of the flat indices of all missing points.
        """
        if self.solver.groups_and_group_solver is not None:
            groups = self.solver.groups_and_group_solver[0]
            items = self.shard.ranges_of_shard(groups.unsolved_ranges(missing), groups.count)
            return items, groups.missing_point_count(items, missing)
        if self.solver.sweep_chains is None:
            items = self.shard.ranges_of_shard(missing, self.job.points.count)
            return items, index_count(items)
        is_missing = IndexSet(missing)
        chains = self.solver.sweep_chains.chains
        items = self.shard.ranges_of_shard(chains.unsolved_ranges(is_missing), chains.count)
        missing_counts = (is_missing[chains.indices(chain)].sum() for item in items for chain in range(*item))
        return items, int(sum(missing_counts))

    def solve(
        self,
        items: list[IndexRange],
        missing: list[IndexRange],
        missing_count: int,
        prepare: Callable[[], object],
    ) -> ReportOfRank:
        """Solves work items together with all other ranks; writes this rank's results into its journal.

        items, missing_count: results of `items_to_solve_and_point_count`. missing: argument of that method.
        prepare: function called before the first solve. Raises EnvironmentIncomplete if a journal cannot be
        written.
        """
        reasons = FailureReasons(self.point_text)
        solver = self.solver
        plan = self.plan

        def keep(index: PointIndexOrIndices, result: Any) -> None:
            is_new = reasons.add(index, result)
            if isinstance(result, GroupResult):
                journal.append_all(np.asarray(index), result.variable_values, is_new)
            else:
                journal.append(int(index), solver.file_values_of_outcome(int(index), result), is_new)

        is_shown = self.ranks.is_first and not self.quiet
        reporter = ProgressReporter(missing_count, self.job.title) if is_shown else SilentProgress()
        directory = journal_directory(self.output)
        try:
            with closing(Journal(directory, self.ranks.rank, plan.layout, plan.fingerprint)) as journal:
                solve = self._item_solver(IndexSet(missing), directory)
                loop = SweepCallbacks(solve=solve, store=keep, prepare=prepare, item_label=self._item_name)
                queue = ChunkQueue(items, self.ranks.size)
                contribution = sweep(self.ranks, queue, loop, reporter, self.stop)
        except OSError as error:
            raise EnvironmentIncomplete(
                f"cannot write into the folder of {self.output}: {error.strerror or error}"
                f"{kept_points_clause(directory, plan.fingerprint)}: make room and run again"
            ) from error
        finally:
            reporter.close()
        failures = list(reasons.example_by_reason.values())
        return ReportOfRank(host=socket.gethostname(), failures=failures, statistics=contribution)

    def _item_solver(
        self, missing: IndexSet, directory: Path
    ) -> Callable[[int], Iterable[tuple[PointIndexOrIndices, Any]]]:
        """Function from the number of a work item (a point, a chain or a group) to its results. missing: flat
        indices of the missing points. directory: folder of the checkpoints of chains."""
        solver = self.solver
        if solver.groups_and_group_solver:
            return GroupSolver(*solver.groups_and_group_solver, solver.solve, missing)
        if solver.sweep_chains:
            checkpoints = Checkpoints(directory, self.plan.fingerprint, solver.sweep_chains.state_from_arrays)
            return ChainSolver(solver.sweep_chains, missing, checkpoints, self.stop)
        return lambda index: ((index, solver.solve(index)),)

    def _item_name(self, item: int) -> str:
        """Name of a work item for the progress display. A group has the name of its first point."""
        if self.solver.sweep_chains:
            return f"chain {item + 1} of {self.solver.sweep_chains.chains.count}, from neighbour to neighbour"
        first_index = (
            int(self.solver.groups_and_group_solver[0].indices(item)[0])
            if self.solver.groups_and_group_solver
            else item
        )
        return f"point {first_index + 1} of {self.job.points.count}"
