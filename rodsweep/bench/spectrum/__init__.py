"""Spectra timed beside dense QZ, Chebyshev and Arnoldi codes."""
