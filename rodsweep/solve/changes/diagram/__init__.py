"""Rows and boundaries of a phase diagram."""
