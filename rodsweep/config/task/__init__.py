"""Config classes, one module per task."""
