"""Stability changes along a path of arms, whose D has no closed form."""
