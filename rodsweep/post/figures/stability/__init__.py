"""Figures of stability: thresholds, classes of rods over planes and rows, curves and normal forms."""
