"""Figures of limit cycles: portraits, amplitudes against a parameter, maps, energy over a period,
animations."""
