"""Benchmark of limit cycles: collocation by rodsweep, time integrators that follow a cycle, and integration
until the motion is periodic."""
