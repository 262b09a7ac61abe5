"""Periodic orbits: meshes, Newton's method, multipliers, symmetry and measures."""
