"""Verdict on an arm from the solvers' numbers: thresholds over its range of drag, and sentences."""
