"""Hopf points and other changes of stability between the points of a file."""
