"""Where the spectrum changes along a parameter: thresholds of a rod, rows and boundaries of a diagram."""
