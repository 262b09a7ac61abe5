"""Thresholds: rodsweep timed beside bisection, continuation codes and the pencil in F."""
