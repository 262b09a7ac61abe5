"""The command `run`: solves points on all ranks, computes variables of all points, completes the file."""
