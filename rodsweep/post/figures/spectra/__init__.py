"""Figures of spectra along one parameter: a line of them, several lines side by side."""
