"""Figures of arms in SI units: axes, maps and panels, and hatches where the model does not apply."""
