"""Files that a run keeps beside its result file until it ends: journals, checkpoints and the lock."""
