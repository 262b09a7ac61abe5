"""Crossings of the imaginary axis along a path of arms, whose determinant D has no closed form."""
