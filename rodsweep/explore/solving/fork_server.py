"""Fork server for solver processes: a process that has imported all modules but has not started MPI or
PETSc."""

from multiprocessing import forkserver, get_context

FORK_SERVER = get_context("forkserver")
"""Multiprocessing context that forks solver processes from the fork server."""


def start_fork_server() -> None:
    """Starts the fork server, which imports its modules while the page imports its own modules."""
    FORK_SERVER.set_forkserver_preload([f"{__package__}.worker"])
    forkserver.ensure_running()
