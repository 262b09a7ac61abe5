# What the job scripts share; sourced by them in the directory of the clone.

# One thread a rank: those of BLAS would compete with the other ranks for the cores.
export OPENBLAS_NUM_THREADS=1 OMP_NUM_THREADS=1 MKL_NUM_THREADS=1

# .venv/bin has the machine's own mpiexec with defaults that suit jobs; it starts ranks on all nodes of the job by
# itself. Where srun has to start them: LAUNCH="srun --mpi=pmix" sbatch ... On a cluster with an MPI of its own load
# its module, install with `make install PETSC=pypi`, and load it again before sbatch.
PATH=$PWD/.venv/bin:$PATH

# run_or_requeue WORD...: `rodsweep run WORD...` on all tasks of the job; returns its exit status. When Slurm warns that
# the time is up, two to three minutes before (so --time must be well above that), the run finishes the points in
# flight and exits with 75, "continue me": then the job goes back to the queue, where Slurm holds it for two minutes.
# The warning goes to this shell only, which hands it on: mpiexec forwards SIGUSR1 to all ranks, but on SIGTERM it kills
# them within two seconds. So SIGTERM is left alone: it means cancelled or requeued, and Slurm sends it to everyone.
run_or_requeue() {
  local run status warned=yes
  ${LAUNCH:-mpiexec -n "$SLURM_NTASKS"} rodsweep run "$@" &
  run=$!
  trap 'warned=yes; kill -USR1 "$run" || :' USR1
  while [ "$warned" ]; do  # a trapped signal ends `wait` before the run ends
    warned=
    wait "$run" && status=0 || status=$?
  done
  trap - USR1
  if [ "$status" -eq 75 ] && ! scontrol requeue "$SLURM_JOB_ID"; then
    echo "this job may not be requeued: submit it again to continue" >&2
  fi
  return "$status"
}
