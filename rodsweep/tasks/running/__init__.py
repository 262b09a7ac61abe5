"""A job of a config, the plan of its file, and exceptions that no solver foresees."""
