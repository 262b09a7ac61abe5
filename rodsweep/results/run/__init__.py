"""Files in the journal directory, beside the result file of an unfinished run: journals and checkpoints."""
