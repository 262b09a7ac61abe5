"""Hopf points and other thresholds of the straight rod, located between neighbouring points of a file."""
