#!/bin/bash
# Merges what jobs/shards.sh computed into RESULT.h5; that file says how to submit it.
#SBATCH --job-name=rodsweep-merge
#SBATCH --nodes=1
#SBATCH --ntasks=1
#SBATCH --time=01:00:00
#SBATCH --kill-on-invalid-dep=yes
#SBATCH --requeue
#SBATCH --open-mode=append
#SBATCH --output=%x-%j.log

set -euo pipefail
cd "$SLURM_SUBMIT_DIR"
. jobs/requeue.sh
config=${1:?usage: sbatch --dependency=afterok:ARRAY jobs/merge.sh CONFIG RESULT.h5}
result=${2:?usage: sbatch --dependency=afterok:ARRAY jobs/merge.sh CONFIG RESULT.h5}
rodsweep merge "$result" "${result%.h5}"-*-of-*.h5 || [ $? -eq 75 ]  # points are missing: the run computes them
# What only all points together give, such as the curves of a phase diagram; and the exit status of the whole.
run_or_requeue "$config" -o "$result"
