"""Spectra along a path in one parameter: followed, predicted, counted."""
