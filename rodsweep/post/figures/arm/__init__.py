"""Figures of arms in SI units: axes, maps and panels, and regions where the model does not apply."""
