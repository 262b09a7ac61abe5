"""What a run keeps beside its file until its points are in it: journals, checkpoints, the lock."""
