"""Thresholds of the straight rod along a parameter (crossings of the imaginary axis, exchanges of the leading
eigenvalue), and phase diagrams in two parameters."""
