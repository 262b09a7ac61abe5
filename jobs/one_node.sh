#!/bin/bash
# Runs a config on one node, or on a part of it; continues by itself when the time is up:
#
#   sbatch [--ntasks=32 --time=12:00:00] jobs/one_node.sh CONFIG [RESULT.h5 [OPTION...]]
#
# Submit it from the directory of the clone. Submitted again it continues, or says that the result is complete. What
# OPTIONs there are says `rodsweep run --help`.
#SBATCH --job-name=rodsweep
#SBATCH --nodes=1
#SBATCH --ntasks=2
#SBATCH --cpus-per-task=1
#SBATCH --ntasks-per-core=1
#SBATCH --time=01:00:00
#SBATCH --signal=B:USR1@120
#SBATCH --requeue
#SBATCH --open-mode=append
#SBATCH --output=%x-%j.log

set -euo pipefail
cd "$SLURM_SUBMIT_DIR"
. jobs/requeue.sh
config=${1:?usage: sbatch jobs/one_node.sh CONFIG [RESULT.h5 [OPTION...]]}
result=${2:-results/$(basename "${config%.*}").h5}
run_or_requeue "$config" -o "$result" "${@:3}"
