"""Benchmark of sweeps: scaling, overhead and memory of complete runs of `rodsweep run`."""
