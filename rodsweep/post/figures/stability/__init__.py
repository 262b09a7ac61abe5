"""Figures of stability: thresholds, stability of rods in planes of two parameters, boundary curves, normal
forms."""
