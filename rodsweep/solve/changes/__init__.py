"""Changes of the spectrum along a parameter: thresholds of a rod, rows and boundaries of a diagram."""
