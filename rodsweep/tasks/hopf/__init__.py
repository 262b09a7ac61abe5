"""Hopf points and other changes of stability at parameter values between the points of a file."""
