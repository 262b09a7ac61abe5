"""Config class of each task."""
