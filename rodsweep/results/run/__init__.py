"""Files in the journal directory, next to the result file of an unfinished run: journals and checkpoints."""
