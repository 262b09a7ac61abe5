"""Benchmark of limit cycles: rodsweep, time integrators, and integration until the motion is periodic."""
