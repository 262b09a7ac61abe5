"""Spectra of rods along a path in one parameter: eigenvalues are predicted, followed and counted."""
