"""Curves and cycles of a phase diagram, and the corresponding variables of the file."""
