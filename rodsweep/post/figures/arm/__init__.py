"""Figures of arms in SI units: axes, maps and panels, and the regions in which the model does not apply."""
