"""Branches of stable and unstable cycles, followed through folds, with their special points; stable states
of the rod along the rows of a phase diagram."""
