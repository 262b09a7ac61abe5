#!/bin/bash
# Runs a config under Slurm; submit it again, or let Slurm requeue it, to continue:
#
#   sbatch [--nodes=4 --ntasks-per-node=32 --time=12:00:00] jobs/slurm.sh CONFIG [RESULT.h5]
#
# Start it from the directory of the clone. A killed job loses only the points in flight; the result
# file and its .journal directory must be on a file system that all nodes share.
#SBATCH --job-name=rodsweep
#SBATCH --ntasks=2
#SBATCH --cpus-per-task=1
#SBATCH --time=01:00:00
#SBATCH --requeue
#SBATCH --open-mode=append
#SBATCH --output=%x-%j.log

set -euo pipefail
cd "${SLURM_SUBMIT_DIR:-$PWD}"
config=${1:?usage: sbatch jobs/slurm.sh CONFIG [RESULT.h5]}
result=${2:-results/$(basename "${config%.*}").h5}

# .venv/bin has an mpiexec that pins the threads of BLAS to one and works inside a job without srun.
# On a cluster with its own MPI install with `make install PETSC=pypi` after loading its module.
PATH="$PWD/.venv/bin:$PATH"
exec mpiexec -n "${SLURM_NTASKS:-2}" rodsweep run "$config" -o "$result"
