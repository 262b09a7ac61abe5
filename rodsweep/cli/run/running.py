"""`rodsweep run`: reads the config, opens the result file, solves the missing points, completes the file."""

import time
from collections.abc import Mapping
from functools import cache
from pathlib import Path

import click

from ...config import read_config, refusals_naming_file
from ...errors import STOPPED_EXIT_STATUS
from ...results.file import provenance
from ...results.file.creation import FinalAdditions
from ...results.file.result_file_writer import ResultFileWriter
from ...results.file.view import read_view
from ...solve.backend.availability import enter_directory, require_solvers, require_working_directory
from ...sweep.points.ranges import IndexRange, index_count
from ...sweep.ranks import Ranks
from ...sweep.stop import StopRequest
from ...tasks.protocol import SweepWideResult
from ...tasks.running.job import Job, job_of_config, result_file_plan
from ...tasks.running.unforeseen_exceptions import TracebackLog, changed_point_failure_reasons, guarded_solver
from ...wording import counted
from ..shared_computations import plan_with_variables_from_config, report_stop, shared_flutter_forces
from .run_end import MAX_FAILURES_PRINTED, ReportOfRank, RunStatistics, last_run_attributes, run_history
from .run_request import RunRequest
from .shard_solver import ShardSolver
from .sweep_wide_computation import PendingSweepWideVariables, SweepWideComputation


def run_config(path: Path, output: Path, request: RunRequest, stop: StopRequest) -> int:
    """Runs the config file `path`, or a shard of it, on all ranks; returns the exit status of the command."""
    require_working_directory()
    ranks = Ranks()
    with ranks.abort_all_ranks_on_error():
        (config, text), directory = ranks.call_on_first_rank(
            lambda: (read_config(path, request.overrides), Path.cwd())
        )
        # Otherwise a rank started in another directory would write its points there, and lose them.
        ranks.require_on_all_ranks(lambda: enter_directory(directory))
        with refusals_naming_file(path):
            if (flutter := shared_flutter_forces(config, ranks, stop)) is None:
                report_stop(ranks, stop)
                return STOPPED_EXIT_STATUS
            job = ranks.call_on_first_rank(lambda: job_of_config(path, config, text, flutter))
        ranks.require_on_all_ranks(require_solvers)
        return _RankRun(ranks, job, output, request, stop).run()


class _RankRun:
    """The part of a run that this rank executes."""

    result_file_writer: ResultFileWriter
    """The result file, on the first rank, after `_open_file_and_find_missing_points`."""

    def __init__(self, ranks: Ranks, job: Job, output: Path, request: RunRequest, stop: StopRequest):
        from ...solve.backend.petsc import blas_description

        self.ranks = ranks
        self.job = job
        self.output = output
        self.stop = stop
        self.request = request
        self.shard = request.shard
        self.clock_at_start = time.monotonic()
        self.date_at_start = provenance.utc_time()
        self.seconds = 0.0
        self.log = TracebackLog(output, ranks.rank, self.job.point_text, request.strict)
        self.solver = guarded_solver(job.solver(), job.layout, self.log)
        self.kernels = provenance.merged_blas_kernels(ranks.gather(blas_description()) or [])
        self.plan = result_file_plan(job, self.solver, self.shard, self.kernels)
        self.prepare = cache(self.solver.warm_up)
        self.shard_solver = ShardSolver(
            ranks=ranks, job=job, solver=self.solver, plan=self.plan, shard=self.shard, output=output,
            stop=stop, quiet=request.quiet, point_text=self.job.point_text,
        )  # fmt: skip
        sweep_wide = self.solver.sweep_wide_solver
        self.sweep_wide = sweep_wide and SweepWideComputation(
            ranks, sweep_wide, output, self.plan.fingerprint, self.log.append_exception, stop
        )

    def run(self) -> int:
        """Solves the missing points, writes the results into the file, and returns the exit status."""
        replaces = self.request.fresh or self.request.extend
        if self.ranks.call_on_first_rank(lambda: replaces or not self.output.exists()):
            plan = plan_with_variables_from_config(self.plan, self.job.task, self.ranks, self.stop)
            if plan is None:
                report_stop(self.ranks, self.stop)
                return STOPPED_EXIT_STATUS
            self.plan = plan
        missing = self.ranks.call_on_first_rank(self._open_file_and_find_missing_points)
        items, requested_count = self.shard_solver.items_to_solve_and_point_count(missing)
        if self.ranks.is_first:
            points = self.job.points.count
            shard_clause = f"; shard {self.shard}" if self.shard.shard_count > 1 else ""
            kept_clause = f", {points - index_count(missing)} kept" if points > index_count(missing) else ""
            left_count = index_count(missing) - requested_count
            if self.sweep_wide and self._lacks_only_sweep_wide_variables(left_count):
                kept_clause += ", then the curves"
            points_text = f"{requested_count} of {counted(points, 'point')} to do"
            self._print_message(f"{self.output}: {points_text}{kept_clause}{shard_clause}")
        contributions: list[ReportOfRank] = []
        if requested_count:
            self.ranks.call_on_first_rank(self._record_blas_kernels)
            contribution = self.shard_solver.solve(items, missing, requested_count, self.prepare)
            contributions = self.ranks.gather(contribution) or []
        pending = self.ranks.call_on_first_rank(
            lambda: self._write_points_of_journals(requested_count, contributions)
        )
        solved: dict[str, int] = {}
        if self.sweep_wide:
            title = None if self.request.quiet else self.job.title
            pending, solved = self.sweep_wide.solve_all(pending, self.prepare, title)
        exceptions = sum(self.ranks.gather(self.log.count) or [])
        return self.ranks.call_on_first_rank(
            lambda: self._finish(requested_count, contributions, pending, solved, exceptions)
        )

    def _lacks_only_sweep_wide_variables(self, missing: int) -> bool:
        """Whether the file lacks only the variables that depend on all points; called on the first rank."""
        return not missing and "finished" not in self.result_file_writer.attributes()

    def _write_points_of_journals(
        self, requested_count: int, contributions: list[ReportOfRank]
    ) -> PendingSweepWideVariables:
        """Writes the points of all journals into the file; returns whether the variables that depend on all
        points are missing, and their work items. requested_count: number of points to be solved in this run.
        contributions: report of every rank."""
        self.seconds = time.monotonic() - self.clock_at_start
        if requested_count:
            history = run_history(contributions, self.ranks.MPI.Get_library_version())
            attributes = {"started": self.date_at_start, "stopped": self.stop.name}
            self.result_file_writer.add_journals(last_run_attributes(self.plan) | history | attributes)
        if not self._lacks_only_sweep_wide_variables(index_count(self.result_file_writer.missing_ranges())):
            return PendingSweepWideVariables(False)
        if not self.sweep_wide:
            return PendingSweepWideVariables(True)
        if not requested_count:
            self._record_blas_kernels()
        items = self.sweep_wide.solver.work_items(read_view(self.output), {})
        return PendingSweepWideVariables(True, items)

    def _print_message(self, text: str, is_problem: bool = False) -> None:
        """Prints a text; in quiet mode only if it reports a problem (`is_problem`)."""
        if is_problem or not self.request.quiet:
            click.echo(text)

    def _open_file_and_find_missing_points(self) -> list[IndexRange]:
        """Opens or creates the result file; returns the ranges of the flat indices of missing points."""
        self.result_file_writer = ResultFileWriter(
            self.output, self.plan, self.request.fresh, self.request.extend
        )
        if self.sweep_wide and (self.request.fresh or not self._lacks_only_sweep_wide_variables(0)):
            self.sweep_wide.item_results.remove_all()
        self._print_result_file_notes()
        return self.result_file_writer.missing_ranges()

    def _print_result_file_notes(self) -> None:
        """Prints the notes of the store on points and journals found in unexpected places."""
        for note in self.result_file_writer.notes:
            self._print_message(f"{self.output}: {note}", is_problem=True)
        self.result_file_writer.notes.clear()

    def _record_blas_kernels(self) -> None:
        """Stores the names of the BLAS kernels of all ranks, and prints a warning if the kernels differ."""
        attributes = self.result_file_writer.attributes()
        stored = provenance.blas_kernels_in(attributes)
        kernels = provenance.merged_blas_kernels(stored, self.kernels.splitlines())
        if kernels != attributes.get(provenance.BLAS_KERNELS_ATTRIBUTE):
            self.result_file_writer.add_journals({provenance.BLAS_KERNELS_ATTRIBUTE: kernels})
        if sentence := provenance.several_blas_kernels_warning(kernels):
            click.echo(f"{self.output}: {sentence}")

    def _write_variables_and_check_missing(self, pending: PendingSweepWideVariables) -> bool:
        """Writes the variables that depend on all points into the file; returns whether they are still
        missing."""
        if not pending.is_missing:
            return False
        result = self.sweep_wide.result(pending.work_items) if self.sweep_wide else SweepWideResult(())
        if result is None:
            self.result_file_writer.add_journals({"stopped": self.stop.name})
            return True
        attributes = {"finished": provenance.utc_time(), "stopped": self.stop.name}
        reasons = changed_point_failure_reasons(result, self.solver.possible_statuses, self.job.point_text)
        self.result_file_writer.finish(
            attributes, FinalAdditions(result.sweep_wide_variables, result.changed_points, reasons)
        )
        if self.sweep_wide:
            self.sweep_wide.item_results.remove_all()
        return False

    def _print_failures(self, contributions: list[ReportOfRank], exceptions: int) -> None:
        """Prints the first failed points, and the name of the file with the tracebacks of exceptions."""
        failures = [failure for contribution in contributions for failure in contribution.failures]
        columns = self.job.points.columns_by_name
        for failure in failures[:MAX_FAILURES_PRINTED]:
            click.echo(f"  {provenance.example_failure_sentence(failure, columns)}")
        if exceptions:
            exceptions_text = counted(exceptions, "unforeseen exception")
            click.echo(
                f"  {exceptions_text}, a bug: please report it with {self.log.path}, which has the traceback"
            )

    def _status_counts_text(self, counts: Mapping[str, int], unsolved: int) -> str:
        """Text with the number of points of each status, `counts`. unsolved: number of unsolved points."""
        missing_texts = {"missing": "of other shards"} if self.shard and not unsolved else {}
        return ", ".join(f"{count} {missing_texts.get(name, name)}" for name, count in counts.items())

    def _finish(
        self,
        requested_count: int,
        contributions: list[ReportOfRank],
        pending: PendingSweepWideVariables,
        solved: dict[str, int],
        exceptions: int,
    ) -> int:
        """Completes the result file, prints how the run ended, and returns the exit status. pending, solved:
        results of `solve_all`. exceptions: number of unforeseen exceptions on all ranks."""
        lacks_sweep_wide_variables = self._write_variables_and_check_missing(pending)
        result_count = len(self.sweep_wide.results) if self.sweep_wide else None
        missing_points = self.result_file_writer.missing_ranges()
        self._print_result_file_notes()
        counts = self.result_file_writer.status_counts()
        self.result_file_writer.close()
        unsolved_count = self.shard_solver.items_to_solve_and_point_count(missing_points)[1]
        text = f"shard {self.shard} of {self.output}" if missing_points else f"{self.output}"
        run_end = RunStatistics(
            ranks=self.ranks.size,
            requested_points=requested_count,
            unsolved_points=unsolved_count,
            points_stored_at_end=self.job.points.count - index_count(missing_points),
            seconds=self.seconds,
            sweep_wide_seconds=time.monotonic() - self.clock_at_start - self.seconds,
            interrupted_points=sum(contribution.statistics.was_interrupted for contribution in contributions),
            solved_items=solved if pending.is_missing and self.sweep_wide else None,
            result_count_for_next_run=result_count if lacks_sweep_wide_variables else None,
        )
        for sentence in run_end.time_sentences() or [f"{text} is complete, nothing to do"]:
            self._print_message(sentence)
        expected = {status.name for status in self.solver.possible_statuses if status.succeeded} | {"missing"}
        is_problem = not set(counts) <= expected
        self._print_message(f"{self.output}: {self._status_counts_text(counts, unsolved_count)}", is_problem)
        self._print_failures(contributions, exceptions)
        if unsolved_count or lacks_sweep_wide_variables:
            end_text = f"stopped by {self.stop.name}" if self.stop else "not complete"
            click.echo(f"{end_text}; {run_end.stored_points_clause()}, the same command continues the run")
            return STOPPED_EXIT_STATUS
        if is_problem:
            click.echo(f"  `rodsweep show {self.output}` says what each status means")
        return int(is_problem)
