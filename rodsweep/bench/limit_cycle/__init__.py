"""Limit cycles: rodsweep timed beside other time integrators, and beside waiting for the cycle."""
