"""End of a run: work done by each rank, attributes of the file, and closing sentences."""

import os
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ...results.file import provenance
from ...results.file.creation import FilePlan
from ...sweep.loop import RankStatistics
from ...wording import counted, duration

MAX_FAILURES_PRINTED = 3
"""Maximum number of failed points named at the end of a run; the file has the status of all points."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ReportOfRank:
    """Report of a rank to the first rank at the end of a run.

    host: name of the machine. failures: for each distinct reason, a text on one point that failed for this
    reason. statistics: numbers and times of the rank's points.
    """

    host: str
    failures: list[str]
    statistics: RankStatistics


def last_run_attributes(plan: FilePlan) -> dict[str, Any]:
    """Attributes of a plan that describe only the last run: versions, commit, options and shard."""
    name_endings = ("_version", "_commit", "_options")
    return {
        name: value
        for name, value in plan.attributes.items()
        if name.endswith(name_endings) or name == "shard"
    }


def run_history(contributions: Sequence[ReportOfRank], mpi_library: str) -> dict[str, Any]:
    """Attributes of a result file that describe a run: number of ranks, hosts, MPI library, Slurm job; points
    and times of each rank. contributions: reports of all ranks."""
    hosts = {contribution.host for contribution in contributions}
    ranks = [contribution.statistics for contribution in contributions[: provenance.MAX_RANK_STATISTICS]]
    numbers = (
        np.array([of_rank.solved_point_count for of_rank in ranks], "i4"),
        np.array([of_rank.busy_seconds for of_rank in ranks], "f4"),
        np.array([of_rank.idle_seconds for of_rank in ranks], "f4"),
    )
    return {
        "ranks": len(contributions),
        "hosts": " ".join(sorted(hosts))[: provenance.MAX_ATTRIBUTE_LENGTH],
        "mpi_library": mpi_library.split("\n", maxsplit=1)[0].strip("\0 "),
        "slurm_job": os.environ.get("SLURM_JOB_ID", ""),
        **dict(zip(provenance.RANK_STATISTICS_ATTRIBUTES, numbers, strict=True)),
    }


@dataclass(frozen=True, slots=True, kw_only=True)
class RunStatistics:
    """Counts and times at the end of a run. ranks: number of ranks."""

    ranks: int
    requested_points: int
    """Number of points to be solved in this run."""
    unsolved_points: int
    """Number of points of this run that are not solved."""
    points_stored_at_end: int
    """Number of points that the file holds at the end of the run."""
    seconds: float
    """Time spent on the points, in s."""
    sweep_wide_seconds: float
    """Time spent on the variables that need all points, in s."""
    interrupted_points: int
    """Number of points interrupted by a stop."""
    solved_items: dict[str, int] | None
    """Number of work items for the curves that this run solved, by kind of item: the phrase
    `WorkItems.done_item_phrase`. None if no curves were to be computed."""
    result_count_for_next_run: int | None
    """Number of work items for the curves whose results are stored for the next run, because the curves are
    incomplete; else None."""

    def time_sentences(self) -> list[str]:
        """Sentences on the times of points and curves; empty if there was nothing to do."""
        sentences = []
        ranks_text = counted(self.ranks, "rank")
        if self.requested_points:
            points = self.requested_points - self.unsolved_points
            seconds_per_point = self.seconds * self.ranks / max(points, 1)
            per_point_text = f" ({duration(seconds_per_point)} per point on one rank)" if points else ""
            sentences.append(
                f"{counted(points, 'point')} in {self.seconds:.2f} s on {ranks_text}{per_point_text}"
            )
        if self.solved_items is not None:
            word = "curves in" if self.result_count_for_next_run is None else "curves stopped after"
            clauses = [f"{word} {self.sweep_wide_seconds:.2f} s on {ranks_text}"]
            for outcome, number in self.solved_items.items():
                item, _, action = outcome.partition(" ")
                clauses += [f"{counted(number, item)} {action}"] if number else []
            sentences.append("; ".join(clauses))
        return sentences

    def stored_points_clause(self) -> str:
        """Clause with the numbers of points, and of results for the curves, that a stopped run has stored."""
        points_text = f"{counted(self.points_stored_at_end, 'point')} kept"
        if self.result_count_for_next_run is not None:
            results_text = counted(self.result_count_for_next_run, "result")
            return f"{points_text}, {results_text} for the curves kept, the other results are missing"
        if self.interrupted_points:
            return f"{points_text}, {self.interrupted_points} interrupted, to be solved again"
        return points_text
