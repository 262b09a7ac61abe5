"""Spectral elements on [0, 1]: quadrature, basis, constant pieces of matrices, and choice of the resolution.

Plain NumPy arrays; no PETSc and no MPI.
"""
