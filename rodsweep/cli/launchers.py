"""The rank of a process before MPI is started, from what launchers say."""

import os


def rank_variables() -> list[str]:
    """The rank of this process as each launcher tells it; nothing where there is none."""
    names = ("OMPI_COMM_WORLD_RANK", "PMIX_RANK", "PMI_RANK", "SLURM_PROCID")
    return [os.environ[name] for name in names if name in os.environ]


def speaks() -> bool:
    """Whether this process is the one that talks, before MPI has been started."""
    return next(iter(rank_variables()), "0") == "0"
