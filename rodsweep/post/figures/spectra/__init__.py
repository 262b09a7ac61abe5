"""Figures of spectra over one parameter: a line of spectra, or several lines side by side."""
