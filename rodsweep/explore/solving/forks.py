"""Solver processes are copies of a process that has imported everything, and has not started MPI or PETSc."""

from multiprocessing import forkserver, get_context

FORKS = get_context("forkserver")


def prepare() -> None:
    """Starts the process from which solver processes are forked, so that it imports while the page imports
    its own modules.
    """
    FORKS.set_forkserver_preload([f"{__package__}.worker"])
    forkserver.ensure_running()
