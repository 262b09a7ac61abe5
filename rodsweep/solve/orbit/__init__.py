"""Periodic orbits of the nonlinear rod: meshes, Newton's method, Floquet multipliers, symmetry and
measures."""
