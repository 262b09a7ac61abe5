"""The job of a config, the plan of the file, and unforeseen exceptions."""
