"""Minimally augmented systems: cycles and their test functions, corrected with the matrix factors of a nearby
cycle."""
