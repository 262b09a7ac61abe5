"""Figures of stability: thresholds, classes of rods in planes and rows, curves and normal forms."""
