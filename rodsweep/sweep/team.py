"""The ranks of a run: who is first, and how an error on one ends all at once."""

import sys
import time
import traceback
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from typing import Any, TypeVar

from ..errors import BUG_STATUS, EnvironmentIncomplete, Refusal

T = TypeVar("T")
S = TypeVar("S")
SHORTEST_PAUSE, LONGEST_PAUSE = 1e-4, 1e-2
"""Seconds between two looks at whether the others have come, at first and after a while."""


class Team:
    """All ranks of MPI's world; a single rank where there is no launcher."""

    def __init__(self) -> None:
        try:
            from mpi4py import MPI
        except ImportError as error:
            raise EnvironmentIncomplete(
                f"mpi4py cannot be imported ({error}); `make install` provides it"
            ) from error
        self.MPI = MPI
        self.comm = MPI.COMM_WORLD.Dup()
        self.rank: int = self.comm.Get_rank()
        self.size: int = self.comm.Get_size()
        if self.size > 1 and MPI.Query_thread() < MPI.THREAD_MULTIPLE:
            raise EnvironmentIncomplete(
                "this MPI was started without MPI_THREAD_MULTIPLE, which rodsweep needs"
            )

    @property
    def first(self) -> bool:
        """Whether this rank is the one that talks, hands out points and writes the file."""
        return self.rank == 0

    def on_first(self, work: Callable[[], T]) -> T:
        """What `work` returns on the first rank, on every rank; its refusals are raised on every rank."""
        outcome: Any = None
        if self.first:
            try:
                outcome = (work(), None)
            except Refusal as error:
                outcome = (None, error)
        self.meet()
        value, refusal = self.comm.bcast(outcome)
        if refusal is not None:
            raise refusal.on_all_ranks()
        return value

    def meet(self) -> None:
        """Waits for all ranks without taking the processor from those that still work, as a barrier would."""
        request, pause = self.comm.Ibarrier(), SHORTEST_PAUSE
        while not request.Test():
            time.sleep(pause)
            pause = min(2 * pause, LONGEST_PAUSE)

    def all_can(self, work: Callable[[], object]) -> None:
        """Does `work` on every rank; where one refuses it, all raise its refusal."""
        refusal: Refusal | None = None
        try:
            work()
        except Refusal as error:
            refusal = error
        refusals = [r for r in self.comm.allgather(refusal) if r is not None]
        if refusals:
            raise refusals[0].on_all_ranks()

    def gather(self, value: T) -> list[T] | None:
        """The values of all ranks on the first rank, None elsewhere."""
        self.meet()
        return self.comm.gather(value)

    def exchange(self, value: T) -> list[T]:
        """The values of all ranks on every rank."""
        self.meet()
        return self.comm.allgather(value)

    def in_order(self, items: Sequence[T], work: Callable[[T], S]) -> list[S]:
        """The work on all items, each done by one of the ranks, on every rank and in their order."""
        parts = self.exchange([work(item) for item in items[self.rank :: self.size]])
        return [parts[i % self.size][i // self.size] for i in range(len(items))]

    @contextmanager
    def together(self) -> Iterator[None]:
        """What fails in here on one rank ends all ranks with its message and exit status: they would wait.

        With a single rank there is nobody to wait, and a refusal that all ranks share needs no abort:
        such exceptions go on.
        """
        try:
            yield
        except BaseException as error:
            if self.size == 1 or getattr(error, "collective", False):
                raise
            if isinstance(error, Refusal):
                sys.stderr.write(f"rodsweep: rank {self.rank}: {error}\n")
            else:
                sys.stderr.write(f"rodsweep: rank {self.rank} failed, all ranks end\n")
                traceback.print_exc()
            for stream in (sys.stdout, sys.stderr):
                with suppress(OSError):  # a full disk under the log must not keep the others waiting
                    stream.flush()
            status = error.exit_status if isinstance(error, Refusal) else BUG_STATUS
            self.comm.Abort(status)
            raise SystemExit(status) from error
