"""Spectral elements on the rod: quadrature, basis, matrices, and the choice of the mesh.

Only NumPy arrays; no PETSc and no MPI.
"""
