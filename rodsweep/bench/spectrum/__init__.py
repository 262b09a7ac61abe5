"""Spectra: rodsweep timed beside dense QZ, Chebyshev and Arnoldi codes."""
