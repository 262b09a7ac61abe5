"""The command `run`: solves points on all ranks, computes variables that depend on all points, completes the
file."""
