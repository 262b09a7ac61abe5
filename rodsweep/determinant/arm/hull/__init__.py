"""Convex regions that hold all eigenvalues of an arm."""
