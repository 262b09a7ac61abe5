"""Periodic orbits on a mesh: Newton's matrix, symmetry, multipliers, what is measured on them."""
