#!/bin/bash
# Runs a config as an array of shards, each a job of its own with a file of its own, and merges them in the end:
#
#   array=$(sbatch --parsable --array=1-10 [--ntasks=32 --time=12:00:00] jobs/shards.sh CONFIG RESULT.h5)
#   sbatch --dependency=afterok:$array jobs/merge.sh CONFIG RESULT.h5
#
# Submit both from the directory of the clone. Shards start as the queue has room, in any order; each continues by
# itself when its time is up. To repeat some of them only, say of how many they are:
#
#   sbatch --array=3,7 jobs/shards.sh CONFIG RESULT.h5 10
#SBATCH --job-name=rodsweep-shard
#SBATCH --nodes=1
#SBATCH --ntasks=1
#SBATCH --cpus-per-task=1
#SBATCH --ntasks-per-core=1
#SBATCH --time=01:00:00
#SBATCH --signal=B:USR1@120
#SBATCH --requeue
#SBATCH --open-mode=append
#SBATCH --output=%x-%A-%a.log

set -euo pipefail
cd "$SLURM_SUBMIT_DIR"
. jobs/requeue.sh
config=${1:?usage: sbatch --array=1-N jobs/shards.sh CONFIG RESULT.h5 [N]}
result=${2:?usage: sbatch --array=1-N jobs/shards.sh CONFIG RESULT.h5 [N]}
i=$SLURM_ARRAY_TASK_ID n=${3:-$SLURM_ARRAY_TASK_MAX}
run_or_requeue "$config" -o "${result%.h5}-$i-of-$n.h5" --shard "$i/$n" && status=0 || status=$?
# 1 means that the shard is whole though some point failed: merging must not wait for ever, and tells it again.
[ "$status" -eq 1 ] || exit "$status"
