"""Spectral elements on the rod: quadrature, basis functions, matrices, and the choice of the mesh.

The package uses NumPy arrays only, neither PETSc nor MPI.
"""
