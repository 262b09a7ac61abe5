"""The job of a config, the plan of its result file, and the treatment of unforeseen exceptions."""
