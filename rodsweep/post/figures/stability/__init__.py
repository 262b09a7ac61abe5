"""Figures of stability: thresholds, classes of rods in planes and rows, boundary curves, normal forms."""
