"""The figures of limit cycles: portraits, amplitudes along an axis, energy over a period, the animation."""
