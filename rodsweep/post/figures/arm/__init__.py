"""Figures of arms in SI units: axes, maps, panels, and where the model does not apply."""
