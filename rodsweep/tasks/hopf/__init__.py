"""Hopf points, onsets and changes of stability at parameter values between the points of a file."""
