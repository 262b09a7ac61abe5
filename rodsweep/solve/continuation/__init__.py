"""Numerical continuation: step length and ends of a curve of solutions, and the search for all curves in a
parameter plane."""
