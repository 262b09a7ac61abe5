"""Branches of stable and unstable cycles, followed through folds, with the special points on each branch."""
