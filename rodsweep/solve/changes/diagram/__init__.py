"""Rows and boundary curves of a phase diagram."""
