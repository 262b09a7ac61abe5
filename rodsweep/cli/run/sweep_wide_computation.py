"""Variables that depend on all points, for example curves of a phase diagram, computed by all ranks."""

from collections.abc import Callable, Iterable
from contextlib import suppress
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from ...results.file.view import read_view
from ...results.run.checkpoints import ItemResults
from ...results.run.journal import journal_directory
from ...solve.backend.solver_pools import destroy_pooled_solvers
from ...solve_progress import SolveStopped, reporting_to
from ...sweep.chunk_queue import ChunkQueue, DependentItemQueue
from ...sweep.loop import PointIndexOrIndices, RankStatistics, SweepCallbacks, sweep
from ...sweep.progress import ProgressReporter, SilentProgress
from ...sweep.ranks import Ranks
from ...sweep.stop import SingleRankCommunication, SolverReportListener, StopRequest
from ...tasks.protocol import NamedArrays, SweepWideResult, SweepWideVariableSolver, WorkItems
from ...tasks.running.unforeseen_exceptions import RUN_ENDING_EXCEPTIONS, SweepWideExceptionCallback


@dataclass(frozen=True, slots=True)
class PendingSweepWideVariables:
    """Variables that depend on all points. is_missing: whether the file lacks these variables. work_items:
    the half curves to be followed, each from a special point in one direction; None if nothing is divided
    among the ranks."""

    is_missing: bool
    work_items: WorkItems | None = None


class SweepWideComputation:
    """Computes the variables of a run that depend on all points, in work items (half curves) shared among the
    ranks."""

    def __init__(
        self,
        ranks: Ranks,
        solver: SweepWideVariableSolver,
        output: Path,
        fingerprint: str,
        note: SweepWideExceptionCallback,
        stop: StopRequest,
    ):
        """solver: computes the variables. output: result file. fingerprint: fingerprint of the plan of this
        file. note: function called with every unforeseen exception; the result of the work item is then
        empty."""
        self.ranks = ranks
        self.solver = solver
        self.output = output
        self.note = note
        self.stop = stop
        self.item_results = ItemResults(journal_directory(output), fingerprint)
        self.results: dict[int, NamedArrays] = {}
        """Results of all finished work items, by number, on the first rank only."""

    def solve_all(
        self, pending: PendingSweepWideVariables, prepare: Callable[[], object], title: str | None
    ) -> tuple[PendingSweepWideVariables, dict[str, int]]:
        """Solves the work items of `pending`, and all that follow from their results, on all ranks, until
        none is left or the run is stopped. Returns (`pending` with the last work items, counts). counts:
        numbers of items that all ranks solved in this run, by `WorkItems.done_item_phrase`; the numbers are 0
        on all ranks but the first. Other arguments: as in `solve`."""
        solved_counts: dict[str, int] = {}
        items = pending.work_items
        while items is not None:
            pending = PendingSweepWideVariables(True, items)
            contributions = self.ranks.gather(self.solve(items, prepare, title)) or []
            count = sum(contribution.solved_point_count for contribution in contributions)
            solved_counts[items.done_item_phrase] = solved_counts.get(items.done_item_phrase, 0) + count
            items = self.ranks.call_on_first_rank(partial(self._items_of_next_stage, items))
        return pending, solved_counts

    def solve(self, items: WorkItems, prepare: Callable[[], object], title: str | None) -> RankStatistics:
        """Solves all work items of `items` that are still missing, on all ranks; returns the work of this
        rank. prepare: function called before the first solve. title: text of the progress display; None for
        no display."""
        results: dict[int, NamedArrays] = {}

        def keep(item: PointIndexOrIndices, result: NamedArrays) -> None:
            self.item_results.write(int(item), result)
            results[int(item)] = result

        def take_results() -> dict[int, NamedArrays]:
            new_results = results.copy()
            results.clear()
            return new_results

        queue = ChunkQueue([], self.ranks.size)
        if self.ranks.is_first:
            self.results = self.item_results.read()
            queue = DependentItemQueue(items, self.results, self.ranks.size)
        self._exchange_starts(items)
        reporter: ProgressReporter | SilentProgress = SilentProgress()
        if self.ranks.is_first and title:
            reporter = ProgressReporter(None, f"{title}, curves", items.progress_noun)
        loop = SweepCallbacks(
            solve=partial(self._solve_item, items), store=keep, prepare=prepare,
            results_since_last_call=take_results, item_label=items.item_label,
        )  # fmt: skip
        try:
            return sweep(self.ranks, queue, loop, reporter, self.stop)
        finally:
            reporter.close()

    def _exchange_starts(self, items: WorkItems) -> None:
        """Sends all ranks the special points at which missing half curves start, so that no rank solves these
        points again."""
        item_numbers = self.ranks.call_on_first_rank(lambda: items.items_to_solve(self.results))
        for starts in self.ranks.gather_on_all_ranks(self.solver.cached_branch_starts(items, item_numbers)):
            self.solver.cache_starts(starts)

    def _solve_item(self, items: WorkItems, item: int) -> Iterable[tuple[int, NamedArrays]]:
        try:
            yield item, self.solver.solve_item(items, item)
        except RUN_ENDING_EXCEPTIONS:
            raise
        except Exception as error:
            destroy_pooled_solvers()
            self.note(items.item_label(item), error)
            yield item, self.solver.empty_result(items)

    def _items_of_next_stage(self, items: WorkItems) -> WorkItems | None:
        """The work items of the stage after the stage of `items`; None if some of `items` are not solved, or
        if no item is left. Called on the first rank."""
        if items.items_to_solve(self.results):
            return None
        next_items = self.solver.work_items(read_view(self.output), self.results)
        return next_items if next_items is not None and next_items.items_to_solve(self.results) else None

    def result(self, items: WorkItems | None) -> SweepWideResult | None:
        """The variables that depend on all points, and the points that change; called on the first rank. None
        if the run was stopped before these variables were complete."""
        if items is not None and items.items_to_solve(self.results):
            return None
        with suppress(SolveStopped), reporting_to(SolverReportListener(SingleRankCommunication(), self.stop)):
            return self.solver.result(read_view(self.output), self.results)
        return None
