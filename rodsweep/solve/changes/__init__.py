"""Thresholds of the straight rod along a parameter (crossings of the imaginary axis, exchanges of the leading
eigenvalue), and diagrams in two parameters."""
