"""Curves and cycles of a phase diagram, and their records in its file."""
