"""The ranks of a run: the first rank, collective calls, and errors that end all ranks at once."""

import sys
import time
import traceback
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from typing import Any, TypeVar

from ..errors import BUG_EXIT_STATUS, EnvironmentIncomplete, UserError, import_failure_error

T = TypeVar("T")
S = TypeVar("S")
SHORTEST_BARRIER_PAUSE_SECONDS = 1e-4
"""First pause, in seconds, between two tests of a barrier; each further pause is twice as long."""
LONGEST_BARRIER_PAUSE_SECONDS = 1e-2
"""Longest pause, in seconds, between two tests of a barrier."""


class Ranks:
    """All ranks of MPI_COMM_WORLD, seen from this rank; a single rank without an MPI launcher."""

    def __init__(self) -> None:
        try:
            from mpi4py import MPI
        except ImportError as error:
            raise import_failure_error("mpi4py", error) from error
        self.MPI = MPI
        # On a communicator of its own, messages of rodsweep cannot meet those of PETSc or of user code.
        self.comm = MPI.COMM_WORLD.Dup()
        self.rank: int = self.comm.Get_rank()
        self.size: int = self.comm.Get_size()
        # The first rank answers requests from a thread while its main thread solves.
        if self.size > 1 and MPI.Query_thread() < MPI.THREAD_MULTIPLE:
            raise EnvironmentIncomplete(
                "MPI does not provide the thread level MPI_THREAD_MULTIPLE, which rodsweep needs on several "
                "ranks; use an MPI built with thread support, or one rank"
            )

    @property
    def is_first(self) -> bool:
        """Whether this is the first rank, which prints, hands out points and writes the result file."""
        return self.rank == 0

    def call_on_first_rank(self, work: Callable[[], T]) -> T:
        """Calls `work` on the first rank only. Every rank returns the result, or raises its `UserError`."""
        outcome: Any = None
        if self.is_first:
            try:
                outcome = (work(), None)
            except UserError as error:
                outcome = (None, error)
        self.wait_for_all()
        # After the barrier, as a broadcast would keep the processor busy while the first rank works.
        value, refusal = self.comm.bcast(outcome)
        if refusal is not None:
            raise refusal.marked_collective()
        return value

    def wait_for_all(self) -> None:
        """Barrier over all ranks that sleeps between tests, so that working ranks keep the processor."""
        request = self.comm.Ibarrier()
        wait_seconds = SHORTEST_BARRIER_PAUSE_SECONDS
        while not request.Test():
            time.sleep(wait_seconds)
            wait_seconds = min(2 * wait_seconds, LONGEST_BARRIER_PAUSE_SECONDS)

    def require_on_all_ranks(self, work: Callable[[], object]) -> None:
        """Calls `work` on every rank. If any rank raises a `UserError`, all ranks raise this error."""
        first_error: UserError | None = None
        try:
            work()
        except UserError as error:
            first_error = error
        # All ranks must take part before any of them raises, or the others would wait forever.
        refusals = [r for r in self.comm.allgather(first_error) if r is not None]
        if refusals:
            raise refusals[0].marked_collective()

    def gather(self, value: T) -> list[T] | None:
        """List of the `value` of every rank, in order of ranks, on the first rank; None on other ranks."""
        self.wait_for_all()
        return self.comm.gather(value)

    def gather_on_all_ranks(self, value: T) -> list[T]:
        """List of the `value` of every rank, in order of ranks, on every rank."""
        self.wait_for_all()
        return self.comm.allgather(value)

    def map_in_order(self, items: Sequence[T], work: Callable[[T], S]) -> list[S]:
        """Results of `work` for all items, in order, on every rank; the items are divided among the ranks."""
        # Dealt out in turn, because neighbouring items often take similar times.
        results_by_rank = self.gather_on_all_ranks([work(item) for item in items[self.rank :: self.size]])
        return [results_by_rank[i % self.size][i // self.size] for i in range(len(items))]

    @contextmanager
    def abort_all_ranks_on_error(self) -> Iterator[None]:
        """Context in which an exception on any rank aborts all ranks, with the rank's message and exit
        status. Otherwise all other ranks would wait forever. An exception propagates without abort if there
        is a single rank, or if all ranks raise the same `UserError`."""
        try:
            yield
        except BaseException as error:
            if self.size == 1 or getattr(error, "is_collective", False):
                raise
            if isinstance(error, UserError):
                sys.stderr.write(f"rodsweep: rank {self.rank}: {error}\n")
            else:
                sys.stderr.write(f"rodsweep: rank {self.rank} failed, all ranks end\n")
                traceback.print_exc()
            for stream in (sys.stdout, sys.stderr):
                with suppress(OSError):  # a full disk under the log must not prevent the abort
                    stream.flush()
            # The launcher ends with this status, which tells a refusal from a bug.
            status = error.exit_status if isinstance(error, UserError) else BUG_EXIT_STATUS
            self.comm.Abort(status)
            # Reached only if Abort returns, which MPI allows.
            raise SystemExit(status) from error
