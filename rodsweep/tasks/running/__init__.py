"""The job of a config, the plan of its file, and unforeseen exceptions."""
