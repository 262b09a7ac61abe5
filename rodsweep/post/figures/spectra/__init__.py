"""Figures of spectra over a parameter: a line of spectra, or several lines side by side."""
