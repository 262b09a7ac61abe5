"""Rank of a process before MPI is started, from the environment variables of launchers such as mpiexec."""

import os


def launcher_rank_values() -> list[str]:
    """Values of the environment variables in which launchers store the rank of a process; empty if the
    process was started without a launcher."""
    names = ("OMPI_COMM_WORLD_RANK", "PMIX_RANK", "PMI_RANK", "SLURM_PROCID")
    return [os.environ[name] for name in names if name in os.environ]


def prints_messages() -> bool:
    """Whether this process prints messages before MPI is started: rank 0, or a process without a launcher."""
    return next(iter(launcher_rank_values()), "0") == "0"
