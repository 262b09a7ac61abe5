"""Benchmark of sweeps: complete runs of `rodsweep run`, with their scaling, overhead and memory."""
