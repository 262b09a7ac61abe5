"""Cycles timed beside other time integrators, and beside waiting."""
