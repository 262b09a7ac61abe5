"""Benchmark of spectra: rodsweep, and peers such as dense QZ, Chebyshev collocation and Arnoldi methods."""
