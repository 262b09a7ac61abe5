"""Figures of spectra: a single point, a list of points, and points along one or several lines."""
