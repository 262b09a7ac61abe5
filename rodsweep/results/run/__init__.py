"""Files beside the result file of an unfinished run: journals, checkpoints and the lock."""
