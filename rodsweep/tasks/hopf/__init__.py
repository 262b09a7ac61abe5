"""Hopf points and other thresholds of the straight rod at parameter values between the points of a file."""
