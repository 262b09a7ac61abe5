"""Curves and cycles of a phase diagram, and their variables in its file."""
