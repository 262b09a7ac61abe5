#!/bin/bash
# Runs a config on whole nodes; continues by itself when the time is up:
#
#   sbatch [--nodes=16 --ntasks-per-node=64 --time=12:00:00] jobs/many_nodes.sh CONFIG [RESULT.h5 [OPTION...]]
#
# Submit it from the directory of the clone. The clone, the result file and the .journal directory beside it must be on
# a file system that all nodes share. Submitted again it continues, or says that the result is complete.
#SBATCH --job-name=rodsweep
#SBATCH --nodes=4
#SBATCH --ntasks-per-node=32
#SBATCH --cpus-per-task=1
#SBATCH --ntasks-per-core=1
#SBATCH --exclusive
#SBATCH --time=01:00:00
#SBATCH --signal=B:USR1@120
#SBATCH --requeue
#SBATCH --open-mode=append
#SBATCH --output=%x-%j.log

set -euo pipefail
cd "$SLURM_SUBMIT_DIR"
. jobs/requeue.sh
# Each rank stays on its core; nobody else is on these nodes. (The mpiexec of .venv hands it on to Open MPI 5 and 6.)
export OMPI_MCA_hwloc_base_binding_policy=${OMPI_MCA_hwloc_base_binding_policy:-core:overload-allowed}
config=${1:?usage: sbatch jobs/many_nodes.sh CONFIG [RESULT.h5 [OPTION...]]}
result=${2:-results/$(basename "${config%.*}").h5}
run_or_requeue "$config" -o "$result" "${@:3}"
