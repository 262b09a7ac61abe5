"""Benchmark of thresholds: rodsweep, and peers such as root finding on spectra and continuation codes."""
