"""Figures of spectra along a line of points: one line, or several lines in separate panels."""
