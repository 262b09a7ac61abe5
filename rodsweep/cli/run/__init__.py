"""The command `run`: points, joint work of the ranks, statuses and the closing of the file."""
