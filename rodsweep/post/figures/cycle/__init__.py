"""Figures of limit cycles: portraits, amplitudes over a parameter, maps, energy over a period, animations."""
