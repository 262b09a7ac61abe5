"""Figures of limit cycles: portraits, amplitudes over a parameter, energy over a period, animation."""
